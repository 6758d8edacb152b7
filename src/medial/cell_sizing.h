#pragma once

#include "sheet_grid.h"

#include <coxa/medial/face_pair.h>
#include <coxa/medial/medial_sheet.h>

namespace coxa::medial {

/// Edge lengths by thickness: options, enlarged where needed to meet the number of cells.
struct CellSizing {
  double per_thickness, smallest, largest;
  double slack = 1.0;  ///< by how much limits at bends and rims were enlarged
  double gradation;
};

/// What the place of a node says about the cells around it.
struct SizeBasis {
  std::vector<double> thickness;  ///< mm
  std::vector<double> bend;       ///< mm: longest edge that follows the bends of both faces
  std::vector<double> rim;        ///< mm: longest edge beside a knife edge
};

SizeBasis size_basis(const SheetGrid& grid, const FacePair& faces, const MedialOptions& options);

/// Wanted edge length of every node, growing along the sheet no faster than the gradation.
void update_sizes(SheetGrid& grid, const SizeBasis& basis, const CellSizing& sizing);

/// Enlarges the smallest cell, then all cells in proportion, until the number of cells expected
/// from area and wanted length meets the limit; leaves the grid with these sizes.
CellSizing sizing_for(SheetGrid& grid, const SizeBasis& basis, const MedialOptions& options);

}  // namespace coxa::medial
