#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// The least of an element's smallest dihedral angle over 12.5 degrees, 180 degrees less its
/// largest one over 22 degrees, and its aspect ratio over 0.25; 0 where it is inverted.
double element_rank(const TetGrid& grid, const Tet& tet);

/// Greatest shape energy of the elements around a node.
double worst_energy(const TetGrid& grid, Index v);

/// Moves a node towards a place, in steps of a fifth of the way, as far as the elements around get
/// no worse than `worst` (shape energy) or than they are. @returns the share of the way
double draw_node(TetGrid& grid, Index v, const Vec3& place, double worst);

/// Raises the worst elements: moves the nodes of elements below the limits, by trial steps along
/// the directions they may slide in, wherever that raises the worst element around the node.
///
/// Elements of rank 1 are left alone.
/// @returns how many nodes moved
Index raise_worst(TetGrid& grid, const SlideGuide& guide);

/// Draws nodes that were let go back to where their kinds keep them, as far as the elements around
/// stay good, or as good as they are.
void draw_back(TetGrid& grid, const SlideGuide& guide);

}  // namespace coxa::meshing
