#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// How freely the connections of a grid may change.
struct FlipRules {
  double below = 0.4;       ///< elements of less quality, and their neighbours, are looked at
  double tolerance = 0.05;  ///< mm: how far new boundary facets may be from the surface, or as far
                            ///< as the old ones were
  int max_tets = 1 << 30;   ///< elements are not made more than this
  bool collapse = true;     ///< edges may vanish, and a node with each
  bool at_creases = false;  ///< of a solid: facets beside creases and corners may change too
};

/// Quality of an element in flips: inverse of its shape energy, 0 where it is inverted.
double flip_quality(const TetGrid& grid, const Tet& t);

/// Changes the connections around poor elements wherever that raises the worst of the elements
/// that change: removes edges (2-2, 3-2, 4-4 and larger swaps, the best of all triangulations of
/// the ring around the edge), replaces a face by an edge (2-3), and collapses edges.
///
/// The boundary changes only between nodes of one kind that slide on a face (or `at_creases`, which
/// themselves stay), and only where the new facets lie as near to the surface.
/// @returns how many changes were made
/// Source: edge removal by dynamic programming after Klincsek 1980 and Shewchuk 2002.
Index flip_poor(TetGrid& grid, const SlideGuide& guide, const FlipRules& rules);

}  // namespace coxa::meshing
