#include "untangle.h"

#include "fill_holes.h"

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa {
namespace {

constexpr int kMaxRings = 5;

Vec3 centroid(const TriMesh& mesh, Index t) {
  return mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
}

// marks every triangle with a vertex in common with a marked one
void widen(const TriMesh& mesh, std::vector<bool>& marked) {
  std::vector<bool> touched(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (marked[static_cast<std::size_t>(t)])
      for (int k = 0; k < 3; ++k) touched[static_cast<std::size_t>(mesh.triangles(t, k))] = true;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k)
      if (touched[static_cast<std::size_t>(mesh.triangles(t, k))])
        marked[static_cast<std::size_t>(t)] = true;
}

// what is left, without islands smaller than the largest piece's hundredth
TriMesh cut_out(const TriMesh& mesh, const std::vector<bool>& marked) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (!marked[static_cast<std::size_t>(t)]) kept.push_back(t);
  if (kept.empty()) return {};
  const TriMesh rest = sub_mesh(mesh, kept).mesh;
  const std::vector<Index> piece = triangle_components(rest);
  std::vector<Index> count(
      static_cast<std::size_t>(*std::max_element(piece.begin(), piece.end())) + 1, 0);
  for (Index p : piece) ++count[static_cast<std::size_t>(p)];
  const Index largest = *std::max_element(count.begin(), count.end());
  std::vector<Index> solid;
  for (Index t = 0; t < rest.n_triangles(); ++t)
    if (100 * count[static_cast<std::size_t>(piece[static_cast<std::size_t>(t)])] >= largest)
      solid.push_back(t);
  return sub_mesh(rest, solid).mesh;
}

// by the vertices before and samples of both; pieces that were cut off count as what was cut out
double largest_move(const TriMesh& before, const TriMesh& after) {
  const TriangleTree new_surface(after.points, after.triangles);
  double squared = 0.0;
  for (const auto& p : before.points.rowwise())
    squared = std::max(squared, new_surface.nearest(p.transpose()).squared_distance);
  return std::max(std::sqrt(squared), surface_distance(after, before).hd);
}

// one attempt; nothing where borders touch, holes cannot be filled or something still meets
std::optional<TriMesh> attempt(const TriMesh& mesh, const std::vector<bool>& marked,
                               double max_hole) {
  const TriMesh rest = cut_out(mesh, marked);
  if (rest.empty()) return std::nullopt;
  try {
    RepairReport aside;
    TriMesh filled = fill_holes(rest, max_hole, aside);
    if (!manifold_fault(filled).empty() || !self_intersections(filled).empty()) return std::nullopt;
    return filled;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

TriMesh untangle(const TriMesh& mesh, const RepairOptions& options, RepairReport& report) {
  const auto pairs = self_intersections(mesh);
  if (pairs.empty()) return mesh;
  const Vec3 place = centroid(mesh, pairs[0][0]);
  const auto where = join_text("the surface intersects itself in ", pairs.size(),
                               " pairs of triangles, first at (", place[0], ", ", place[1], ", ",
                               place[2], ") mm");
  const std::vector<Index> piece = triangle_components(mesh);
  std::vector<bool> marked(static_cast<std::size_t>(mesh.n_triangles()), false);
  for (const auto& [s, t] : pairs) {
    if (piece[static_cast<std::size_t>(s)] != piece[static_cast<std::size_t>(t)])
      fail(ErrorCode::bad_mesh, where, ": two separate bodies overlap");
    marked[static_cast<std::size_t>(s)] = marked[static_cast<std::size_t>(t)] = true;
  }
  for (int ring = 0; ring < kMaxRings; ++ring, widen(mesh, marked)) {
    std::optional<TriMesh> result = attempt(mesh, marked, options.max_hole);
    if (!result) continue;
    const double move = largest_move(mesh, *result);
    if (move > options.max_move)
      fail(ErrorCode::bad_mesh, where, "; cutting it out would move the surface by ", move,
           " mm, more than ", options.max_move, " mm");
    report.untangled_triangles +=
        static_cast<Index>(std::count(marked.begin(), marked.end(), true));
    report.largest_move = std::max(report.largest_move, move);
    return std::move(*result);
  }
  fail(ErrorCode::bad_mesh, where, " and could not be untangled");
}

}  // namespace coxa
