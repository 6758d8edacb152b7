#pragma once

#include <filesystem>
#include <string_view>

namespace coxa::view {

/// Writes a file that appears whole or not at all. @throws Error bad_file if it cannot be written
void write_whole(const std::filesystem::path& path, std::string_view bytes);

}  // namespace coxa::view
