#include "fewer_triangles.h"

#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/remesh.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace coxa {
namespace {

// vertices within `reach` of the corners of triangles that cut each other
std::vector<bool> crowded(const TriMesh& mesh, const TriMesh& cut, double reach) {
  std::vector<bool> marked(static_cast<std::size_t>(mesh.n_vertices()), false);
  std::vector<Index> triangles;
  for (const auto& pair : self_intersections(cut))
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  const TriMesh bad = sub_mesh(cut, triangles).mesh;
  if (bad.empty()) return marked;
  const TriangleTree tree(bad.points, bad.triangles);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    marked[static_cast<std::size_t>(v)] =
        tree.nearest_within(mesh.points.row(v).transpose(), reach).has_value();
  return marked;
}

// about that many triangles that follow the shape, more of them where fewer would cut each other;
// nullopt where that does not help
std::optional<TriMesh> decimated(const TriMesh& mesh, Index n_triangles, double reach) {
  constexpr int kTries = 3;
  std::vector<bool> kept(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const TriMesh fewer = decimate(mesh, {.n_triangles = n_triangles, .kept = kept});
    TriMesh unfolded = fewer;
    if (update_unfolded(unfolded) && validate(unfolded).valid()) return unfolded;
    const std::vector<bool> more = crowded(mesh, fewer, reach * (1 << attempt));
    std::transform(kept.begin(), kept.end(), more.begin(), kept.begin(), std::logical_or<>());
  }
  return std::nullopt;
}

}  // namespace

TriMesh fewer_triangles(const TriMesh& raw, double target_edge, double spacing) {
  TriMesh even = remesh(raw, {.target_edge = target_edge});
  if (update_unfolded(even) && validate(even).valid()) return even;
  const double of_triangle = 0.25 * std::sqrt(3.0) * target_edge * target_edge;
  const double wanted = triangle_areas(raw).sum() / of_triangle;
  TriMesh fewest = raw;
  for (const double share : {4.0, 1.5}) {
    const auto n = std::max<Index>(static_cast<Index>(share * wanted), 4);
    if (n >= fewest.n_triangles()) continue;
    std::optional<TriMesh> fewer = decimated(fewest, n, spacing);
    if (!fewer) break;
    fewest = std::move(*fewer);
  }
  return fewest;
}

}  // namespace coxa
