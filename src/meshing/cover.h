#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

#include <coxa/mesh/tri_mesh.h>

#include <cstddef>
#include <vector>

namespace coxa::meshing {

struct CoverOptions {
  double limit = 0.1;  ///< mm, >= 0: places of the surface farther than this from the boundary
  double worst = 2.5;  ///< shape energy, >= 1: allowed for elements around a node that is moved,
                       ///< or as much as there was
  std::size_t most = 4000;  ///< places that are tried, the farthest ones
  std::ptrdiff_t room = 0;  ///< elements that may be added by splitting edges of the boundary
};

/// Draws boundary nodes to corners, ridges and tips of the surface that the boundary cuts off, and
/// keeps them there, where that brings all of the surface nearby nearer to the boundary. Where none
/// can go, an edge of the boundary is split and the new node goes.
/// @returns how many were drawn or made
Index cover_far_places(TetGrid& grid, const TriMesh& surface, const CoverOptions& options);

}  // namespace coxa::meshing
