#pragma once

#include "sheet_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// Moves face nodes that are near a sharp bend of the surface onto it and keeps them there, where
/// that inverts no element. @returns how many were moved
Index snap_to_creases(TetGrid& grid, const SheetGuide& guide);

}  // namespace coxa::meshing
