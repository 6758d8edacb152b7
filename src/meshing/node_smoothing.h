#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// Moves every node, one after the other, to where the sum of its elements' shape energies to the
/// power `power` is least: one Newton step along the directions it may slide in, shortened until
/// the sum falls. No element is ever inverted by it.
///
/// @param power  >= 1: larger values care more for the worst elements
/// @returns how many nodes moved
Index update_positions(TetGrid& grid, const SlideGuide& guide, double power);

/// The same for the nodes of elements worse than `energy` only.
Index update_worst(TetGrid& grid, const SlideGuide& guide, double power, double energy);

/// Elements whose volume is not positive.
Index count_inverted(const TetGrid& grid);

/// Brings inverted elements back by moving the nodes around them, with an energy that stays finite
/// through the inversion. @returns how many are left
Index untangle(TetGrid& grid, const SlideGuide& guide);

}  // namespace coxa::meshing
