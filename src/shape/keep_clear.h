#pragma once

#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

/// A closed surface, which must outlive this, and how far others keep from it.
struct Obstacle {
  const TriangleTree* surface = nullptr;
  double gap = 0.0;  ///< mm
};

/// Moves a point to `gap` (mm) outside of a closed surface, where that is within `reach`.
/// @returns whether it had to move
bool push_out(Vec3& p, const TriangleTree& tree, double gap, double reach);

/// Evens a closed surface where it folds and pushes it out of obstacles, in turn, until neither is
/// needed.
/// @throws Error bad_mesh if folds stay
void update_clear(TriMesh& mesh, const std::vector<Obstacle>& obstacles);

}  // namespace coxa::shape
