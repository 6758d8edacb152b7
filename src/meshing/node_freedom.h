#pragma once

#include <coxa/mesh/tri_mesh.h>

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

/// Orthonormal directions (columns) in which node v may move: those of its kind, or all three once
/// it was let go.
Directions free_directions(const TetGrid& grid, const SlideGuide& guide, Index v);

/// Where node v goes that is drawn to p: to the place its kind allows, or up to its reach away from
/// there towards p.
Vec3 allowed_place(const TetGrid& grid, const SlideGuide& guide, Index v, const Vec3& p);

/// Lets a node go `reach` mm away from where its kind keeps it; corners become border nodes.
void let_go(TetGrid& grid, Index v, double reach);

/// mm: how far the nodes that were let go are from where their kinds would keep them and from the
/// surface, at most. (A border may run elsewhere since cells were left out.)
double largest_departure(const TetGrid& grid, const SlideGuide& guide, const TriMesh& surface);

}  // namespace coxa::meshing
