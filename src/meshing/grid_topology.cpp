#include "grid_topology.h"

#include "tet_boundary.h"

#include <algorithm>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

bool contains(const Tet& t, Index v) { return std::find(t.begin(), t.end(), v) != t.end(); }

Facet facet_opposite(const Tet& t, std::size_t corner) {
  switch (corner) {
    case 0:
      return {t[1], t[2], t[3]};
    case 1:
      return {t[0], t[3], t[2]};
    case 2:
      return {t[0], t[1], t[3]};
    default:
      return {t[0], t[2], t[1]};
  }
}

bool on_boundary(const TetGrid& grid, const Facet& f) {
  int count = 0;
  for (const Index t : grid.around[at(f[0])])
    count += contains(grid.tets[at(t)], f[1]) && contains(grid.tets[at(t)], f[2]);
  return count == 1;
}

bool edge_on_boundary(const TetGrid& grid, Index a, Index b) {
  for (const Index t : grid.around[at(a)]) {
    const Tet& tet = grid.tets[at(t)];
    if (!contains(tet, b)) continue;
    for (std::size_t k = 0; k < 4; ++k)
      if (tet[k] != a && tet[k] != b && on_boundary(grid, facet_opposite(tet, k))) return true;
  }
  return false;
}

bool node_on_boundary(const TetGrid& grid, Index v) {
  for (const Index t : grid.around[at(v)]) {
    const Tet& tet = grid.tets[at(t)];
    for (std::size_t k = 0; k < 4; ++k)
      if (tet[k] != v && on_boundary(grid, facet_opposite(tet, k))) return true;
  }
  return false;
}

bool has_edge(const TetGrid& grid, Index a, Index b) {
  return std::any_of(grid.around[at(a)].begin(), grid.around[at(a)].end(),
                     [&](Index t) { return contains(grid.tets[at(t)], b); });
}

bool has_face(const TetGrid& grid, Index a, Index b, Index c) {
  return std::any_of(grid.around[at(a)].begin(), grid.around[at(a)].end(), [&](Index t) {
    return contains(grid.tets[at(t)], b) && contains(grid.tets[at(t)], c);
  });
}

EdgeRing ring_around(const TetGrid& grid, Index a, Index b) {
  EdgeRing ring;
  std::vector<std::array<Index, 2>> steps;  // from corner to corner
  for (const Index t : grid.around[at(a)]) {
    const Tet& tet = grid.tets[at(t)];
    if (!contains(tet, b)) continue;
    ring.tets.push_back(t);
    const auto corner_a =
        static_cast<std::size_t>(std::find(tet.begin(), tet.end(), a) - tet.begin());
    // the facet opposite a runs clockwise seen from a, so counter-clockwise from beyond: turn it
    // until b comes first, the other two then run counter-clockwise seen from b
    Facet f = facet_opposite(tet, corner_a);
    while (f[0] != b) std::rotate(f.begin(), f.begin() + 1, f.end());
    steps.push_back({f[1], f[2]});
  }
  std::size_t start = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool reached =
        std::any_of(steps.begin(), steps.end(), [&](const auto& s) { return s[1] == steps[i][0]; });
    if (reached) continue;
    ring.closed = false;
    start = i;
  }
  ring.corners.push_back(steps[start][0]);
  Index next = steps[start][1];
  for (std::size_t done = 1; done < steps.size(); ++done) {
    ring.corners.push_back(next);
    const auto step =
        std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s[0] == next; });
    if (step == steps.end() || (*step)[1] == ring.corners[0]) break;
    next = (*step)[1];
  }
  if (!ring.closed) ring.corners.push_back(next);
  const std::size_t expected = steps.size() + (ring.closed ? 0 : 1);
  if (ring.corners.size() != expected) ring.corners.clear();
  return ring;
}

std::vector<char> boundary_nodes(const TetGrid& grid) {
  std::vector<char> found(grid.x.size(), 0);
  const Triangles facets = boundary_of(grid);
  for (Index i = 0; i < facets.size(); ++i) found[at(facets.data()[i])] = 1;
  return found;
}

}  // namespace coxa::meshing
