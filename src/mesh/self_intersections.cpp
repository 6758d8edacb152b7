#include <coxa/mesh/validate.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/predicates.h>
#include <coxa/geom/triangle_tree.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace coxa {
namespace {

using Corners = std::array<Index, 3>;

Corners corners_of(const TriMesh& mesh, Index t) {
  return {mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)};
}

bool has_area(const TriMesh& mesh, Index t) {
  const auto [a, b, c] = corners_of(mesh, t);
  const Vec3 p = mesh.points.row(a), q = mesh.points.row(b), r = mesh.points.row(c);
  for (int axis = 0; axis < 3; ++axis)
    if (orientation_in_plane(p, q, r, axis) != 0) return true;
  return false;
}

// the shared vertices first, the others in cyclic order
void shared_first(Corners& a, Corners& b, std::size_t& n_shared) {
  n_shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto place = std::find(b.begin() + static_cast<std::ptrdiff_t>(n_shared), b.end(), a[i]);
    if (place == b.end()) continue;
    std::swap(a[i], a[n_shared]);
    std::iter_swap(place, b.begin() + static_cast<std::ptrdiff_t>(n_shared));
    ++n_shared;
  }
}

// two triangles over the edge vw with apexes p and q: folded onto each other?
bool folded(const Vec3& v, const Vec3& w, const Vec3& p, const Vec3& q) {
  if (orientation(v, w, p, q) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const int side = orientation_in_plane(v, w, p, axis);
    if (side != 0) return side == orientation_in_plane(v, w, q, axis);
  }
  return false;
}

bool meet_wrongly(const TriMesh& mesh, Index s, Index t) {
  Corners a = corners_of(mesh, s), b = corners_of(mesh, t);
  std::size_t n_shared = 0;
  shared_first(a, b, n_shared);
  const auto at = [&](Index v) { return Vec3(mesh.points.row(v)); };
  if (n_shared == 3) return true;
  if (n_shared == 2) return folded(at(a[0]), at(a[1]), at(a[2]), at(b[2]));
  const Vec3 a0 = at(a[0]), a1 = at(a[1]), a2 = at(a[2]), b0 = at(b[0]), b1 = at(b[1]),
             b2 = at(b[2]);
  if (n_shared == 1)
    return segment_meets_triangle(a1, a2, b0, b1, b2) || segment_meets_triangle(b1, b2, a0, a1, a2);
  return triangles_meet(a0, a1, a2, b0, b1, b2);
}

}  // namespace

std::vector<std::array<Index, 2>> self_intersections(const TriMesh& mesh) {
  std::vector<Index> all(static_cast<std::size_t>(mesh.n_triangles()));
  std::iota(all.begin(), all.end(), 0);
  return self_intersections(mesh, all);
}

std::vector<std::array<Index, 2>> self_intersections(const TriMesh& mesh,
                                                     const std::vector<Index>& some) {
  if (some.empty()) return {};
  const TriangleTree tree(mesh.points, mesh.triangles);
  std::vector<bool> looks(static_cast<std::size_t>(mesh.n_triangles()), false);
  for (const Index s : some) looks[static_cast<std::size_t>(s)] = true;
  std::vector<std::vector<Index>> partners(some.size());
  parallel_for(std::ssize(some), [&](Index i) {
    const Index s = some[static_cast<std::size_t>(i)];
    if (!has_area(mesh, s)) return;
    const Points corners = mesh.points(mesh.triangles.row(s), Eigen::all);
    for (Index t : tree.overlapping(corners.colwise().minCoeff(), corners.colwise().maxCoeff())) {
      const bool once = t > s || !looks[static_cast<std::size_t>(t)];
      if (t != s && once && has_area(mesh, t) && meet_wrongly(mesh, s, t))
        partners[static_cast<std::size_t>(i)].push_back(t);
    }
  });
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t i = 0; i < some.size(); ++i)
    for (Index t : partners[i]) pairs.push_back({std::min(some[i], t), std::max(some[i], t)});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace coxa
