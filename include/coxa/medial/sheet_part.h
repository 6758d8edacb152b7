#pragma once

#include <coxa/core/types.h>

#include <array>
#include <vector>

namespace coxa::medial {

using SheetCell = std::array<Index, 3>;

/// Number of the piece of every cell; pieces hang together by edges.
std::vector<Index> sheet_pieces(const std::vector<SheetCell>& cells);

/// Keeps the largest piece, and where cells meet in a node only, the fan with most cells: what is
/// left is one manifold sheet.
/// @param areas  mm², per cell   @returns per cell: 1 if it is kept
std::vector<char> manifold_part(const std::vector<SheetCell>& cells,
                                const std::vector<double>& areas);

}  // namespace coxa::medial
