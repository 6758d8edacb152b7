#include "flip_guard.h"

#include "grid_topology.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <vector>

namespace coxa::meshing {
namespace {

constexpr double kLeastCosine = 0.6;  // between the normals of old and new facets

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

bool slides(NodeKind k) { return k == NodeKind::first_face || k == NodeKind::second_face; }

std::vector<Index> neighbours(const TetGrid& grid, Index v) {
  std::vector<Index> all;
  for (const Index t : grid.around[at(v)])
    for (const Index u : grid.tets[at(t)])
      if (u != v) all.push_back(u);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// boundary facets at v, outward, v first
std::vector<Facet> facets_at(const TetGrid& grid, Index v) {
  std::vector<Facet> found;
  for (const Index t : grid.around[at(v)]) {
    const Tet& tet = grid.tets[at(t)];
    for (std::size_t k = 0; k < 4; ++k) {
      if (tet[k] == v) continue;
      Facet f = facet_opposite(tet, k);
      if (!on_boundary(grid, f)) continue;
      while (f[0] != v) std::rotate(f.begin(), f.begin() + 1, f.end());
      found.push_back(f);
    }
  }
  return found;
}

Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).normalized();
}

// what both nodes are joined to must be joined to the edge between them (Dey et al. 1999)
bool links_agree(const TetGrid& grid, Index a, Index b) {
  const EdgeRing ring = ring_around(grid, a, b);
  if (ring.corners.empty()) return false;
  const std::vector<Index> of_a = neighbours(grid, a), of_b = neighbours(grid, b);
  std::vector<Index> common;
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                        std::back_inserter(common));
  if (common.size() != ring.corners.size()) return false;
  for (std::size_t k = ring.closed ? 0 : 1; k + (ring.closed ? 0 : 1) < ring.corners.size(); ++k)
    if (edge_on_boundary(grid, a, ring.corners[k]) && edge_on_boundary(grid, b, ring.corners[k]))
      return false;
  for (const Index t : grid.around[at(b)]) {
    const Tet& tet = grid.tets[at(t)];
    if (contains(tet, a)) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      if (tet[k] == b) continue;
      const Facet f = facet_opposite(tet, k);
      std::array<Index, 2> rest{};
      std::size_t n = 0;
      for (const Index v : f)
        if (v != b) rest[n++] = v;
      if (!has_face(grid, a, rest[0], rest[1])) continue;
      const bool joined = std::any_of(ring.tets.begin(), ring.tets.end(), [&](Index s) {
        return contains(grid.tets[at(s)], rest[0]) && contains(grid.tets[at(s)], rest[1]);
      });
      if (!joined) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<NodeKind> FlipGuard::face_of(NodeKind a, NodeKind b) const {
  if (a == b && slides(a)) return a;
  const bool beside_crease = at_creases_ && on_first_face(a) && on_first_face(b);
  if (beside_crease && (slides(a) || slides(b))) return NodeKind::first_face;
  return std::nullopt;
}

double FlipGuard::departure(NodeKind kind, const Vec3& a, const Vec3& b, const Vec3& c) const {
  double largest = 0.0;
  for (const Vec3& p :
       {Vec3((a + b + c) / 3.0), Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))})
    largest = std::max(largest, (guide_.place(kind, p) - p).norm());
  return largest;
}

bool FlipGuard::allows_swap(const TetGrid& grid, Index a, Index b, Index p, Index q) const {
  return !has_edge(grid, p, q) && keeps_shape(grid, a, b, p, q);
}

bool FlipGuard::allows_peeling(const TetGrid& grid, Index a, Index b, Index p, Index q) const {
  return at_creases_ && !edge_on_boundary(grid, p, q) && keeps_shape(grid, a, b, p, q);
}

bool FlipGuard::keeps_shape(const TetGrid& grid, Index a, Index b, Index p, Index q) const {
  const auto face = face_of(grid.kinds[at(a)], grid.kinds[at(b)]);
  if (!face) return false;
  const NodeKind kind = *face;
  for (const Index v : {p, q})
    if (!face_of(kind, grid.kinds[at(v)])) return false;
  const Vec3 &x = grid.x[at(a)], &y = grid.x[at(b)], &u = grid.x[at(p)], &v = grid.x[at(q)];
  // seen from outside the facets run a, q, p … or the other way round: only agreement counts
  const Vec3 first = normal_of(x, y, u), second = normal_of(y, x, v);
  const Vec3 third = normal_of(u, v, y), fourth = normal_of(v, u, x);
  const double side = third.dot(first + second) >= 0.0 ? 1.0 : -1.0;
  for (const Vec3& n : {third, fourth})
    for (const Vec3& m : {first, second})
      if (side * n.dot(m) < kLeastCosine) return false;
  const double before = std::max(departure(kind, x, y, u), departure(kind, x, y, v));
  const double after = std::max(departure(kind, u, v, x), departure(kind, u, v, y));
  return after <= std::max(tolerance_, before);
}

bool FlipGuard::along_crease(const TetGrid& grid, Index a, Index b) const {
  const NodeKind from = grid.kinds[at(b)], to = grid.kinds[at(a)];
  if (!at_creases_ || from != NodeKind::first_crease || !on_first_face(to) || slides(to))
    return false;
  constexpr double kBeside = 0.1;  // of the way
  const Vec3 home = guide_.place(from, grid.x[at(b)]), way = grid.x[at(a)] - home;
  const Vec3 middle = home + 0.5 * way;
  return (guide_.place(from, middle) - middle).norm() <= kBeside * way.norm();
}

bool FlipGuard::allows_collapse(const TetGrid& grid, Index a, Index b) const {
  if (!links_agree(grid, a, b)) return false;
  const std::vector<Facet> facets = facets_at(grid, b);
  if (facets.empty()) return true;
  const bool crease = along_crease(grid, a, b);
  const NodeKind kind = crease ? NodeKind::first_face : grid.kinds[at(b)];
  if (!edge_on_boundary(grid, a, b)) return false;
  if (!crease && (!slides(kind) || !face_of(kind, grid.kinds[at(a)]))) return false;
  for (const Facet& f : facets) {
    if (f[1] == a || f[2] == a) continue;
    const Vec3 &x = grid.x[at(b)], &y = grid.x[at(f[1])], &z = grid.x[at(f[2])], &p = grid.x[at(a)];
    if (normal_of(p, y, z).dot(normal_of(x, y, z)) < kLeastCosine) return false;
    if (departure(kind, p, y, z) > std::max(tolerance_, departure(kind, x, y, z))) return false;
    if (has_face(grid, a, f[1], f[2])) return false;
  }
  return true;
}

}  // namespace coxa::meshing
