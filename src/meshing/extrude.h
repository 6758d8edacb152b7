#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

#include <coxa/medial/medial_sheet.h>
#include <coxa/medial/sheet_part.h>

namespace coxa::meshing {

/// Tetrahedra extruded from a medial sheet.
struct Extrusion {
  TetGrid grid;
  Index n_reduced = 0;                   ///< columns near the rim with fewer layers than asked for
  std::vector<medial::SheetCell> cells;  ///< of the sheet
  std::vector<Index> cell_of;            ///< per tetrahedron of the grid
};

/// Drops the cells with inverted elements, and what then hangs together in a node only.
/// @returns how many cells went
Index drop_inverted_cells(Extrusion& made);

/// Projects every node of the sheet to both faces, stacks `layers` layers between, and splits the
/// prisms so that diagonals match.
///
/// Neighbouring levels are shifted by half a cell against each other along the direction in which
/// the diagonals run: a prism lattice split in three then becomes a body-centred cubic one, whose
/// elements reach an aspect ratio of 0.95 instead of 0.79.
Extrusion extrude(const medial::MedialSheet& sheet, const SlideGuide& guide, int layers);

}  // namespace coxa::meshing
