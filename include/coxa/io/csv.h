#pragma once

#include <string>
#include <vector>

namespace coxa::io {

/// Cells of one line of a CSV table; a cell may be quoted, with commas and doubled quotes inside.
std::vector<std::string> csv_cells(const std::string& line);

}  // namespace coxa::io
