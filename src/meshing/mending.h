#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// Brings inverted elements back where `untangle` could not: the nodes around them may leave the
/// surface, by more and more. @returns how many are left
Index untangle_freely(TetGrid& grid, const SlideGuide& guide);

/// Raises elements that stay below the limits while their nodes keep to the surface: these nodes
/// may leave it, by as little as helps.
void raise_freely(TetGrid& grid, const SlideGuide& guide);

/// Whether an element is so near to the limits that its nodes may leave the surface for it.
bool has_poor_element(const TetGrid& grid);

/// Drops elements still far below the limits that stick out at the boundary, where that leaves it
/// manifold. @returns how many went
Index drop_poor_elements(TetGrid& grid);

}  // namespace coxa::meshing
