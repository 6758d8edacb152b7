#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace coxa::serve {

/// A CSV file as `{"columns": […], "rows": [[…]]}`: numbers where they are numbers, null where a
/// cell is empty, else text. Lines that begin with # are passed over.
/// @throws Error bad_file if it cannot be read or a line has another number of cells
nlohmann::json csv_table(const std::filesystem::path& path);

}  // namespace coxa::serve
