#include "node_freedom.h"

#include <coxa/geom/triangle_tree.h>

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

Directions free_directions(const TetGrid& grid, const SlideGuide& guide, Index v) {
  if (grid.reach[at(v)] > 0.0) return Mat3::Identity();
  return guide.directions(grid.kinds[at(v)], grid.x[at(v)]);
}

Vec3 allowed_place(const TetGrid& grid, const SlideGuide& guide, Index v, const Vec3& p) {
  const Vec3 kept = guide.place(grid.kinds[at(v)], p);
  const double reach = grid.reach[at(v)], away = (p - kept).norm();
  if (reach <= 0.0) return kept;
  return away <= reach ? p : Vec3(kept + reach / away * (p - kept));
}

void let_go(TetGrid& grid, Index v, double reach) {
  NodeKind& kind = grid.kinds[at(v)];
  if (kind == NodeKind::inside) return;
  if (kind == NodeKind::first_corner) kind = NodeKind::first_border;
  if (kind == NodeKind::second_corner) kind = NodeKind::second_border;
  if (kind == NodeKind::rim_corner) kind = NodeKind::rim_edge;
  grid.reach[at(v)] = std::max(grid.reach[at(v)], reach);
}

double largest_departure(const TetGrid& grid, const SlideGuide& guide, const TriMesh& surface) {
  const TriangleTree tree(surface.points, surface.triangles);
  double largest = 0.0;
  for (std::size_t v = 0; v < grid.x.size(); ++v) {
    if (grid.reach[v] <= 0.0 || grid.around[v].empty()) continue;
    const Vec3& p = grid.x[v];
    const double own = (p - guide.place(grid.kinds[v], p)).norm();
    if (own > largest)
      largest = std::max(largest, std::min(own, std::sqrt(tree.nearest(p).squared_distance)));
  }
  return largest;
}

}  // namespace coxa::meshing
