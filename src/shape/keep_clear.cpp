#include "keep_clear.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/validate.h>

#include <cmath>

namespace coxa::shape {
namespace {

constexpr int kRounds = 12;
// mm: what is farther from an obstacle's surface is looked at no more
constexpr double kReach = 6.0;

/// One pass over all vertices. @returns how many had to move
Index pushed(TriMesh& mesh, const std::vector<Obstacle>& obstacles) {
  std::vector<char> moved(static_cast<std::size_t>(mesh.n_vertices()), 0);
  parallel_for(mesh.n_vertices(), [&](Index v) {
    Vec3 p = mesh.points.row(v);
    for (const Obstacle& obstacle : obstacles) {
      if (push_out(p, *obstacle.surface, obstacle.gap, kReach))
        moved[static_cast<std::size_t>(v)] = 1;
    }
    mesh.points.row(v) = p;
  });
  Index count = 0;
  for (const char m : moved) count += m;
  return count;
}

}  // namespace

bool push_out(Vec3& p, const TriangleTree& tree, double gap, double reach) {
  const auto near = tree.nearest_within(p, reach);
  if (!near) return false;
  const double height = tree.sign_at(p, *near) * std::sqrt(near->squared_distance);
  if (height >= gap || std::abs(height) < 1e-9) return false;
  p = near->point + (gap / height) * (p - near->point);
  return true;
}

void update_clear(TriMesh& mesh, const std::vector<Obstacle>& obstacles) {
  bool whole = false;
  for (int round = 0; round < kRounds; ++round) {
    const Index moved = pushed(mesh, obstacles);
    whole = update_unfolded(mesh);
    if (moved == 0 && whole) return;
  }
  if (!whole)
    fail(ErrorCode::bad_mesh, "a generic surface folds in ", self_intersections(mesh).size(),
         " places");
}

}  // namespace coxa::shape
