#include "tet_boundary.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Facet {
  std::array<Index, 3> sorted, outward;
};

// in the order of their lowest corner, those of one corner in the order of the others
void update_ordered(std::vector<Facet>& facets) {
  Index n_nodes = 0;
  for (const Facet& f : facets) n_nodes = std::max(n_nodes, f.sorted[0] + 1);
  std::vector<std::size_t> begin(at(n_nodes) + 1, 0);
  for (const Facet& f : facets) ++begin[at(f.sorted[0]) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Facet> ordered(facets.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (const Facet& f : facets) ordered[next[at(f.sorted[0])]++] = f;
  const auto place = [&](std::size_t i) {
    return ordered.begin() + static_cast<std::ptrdiff_t>(i);
  };
  for (std::size_t v = 0; v < next.size(); ++v)
    std::sort(place(begin[v]), place(begin[v + 1]),
              [](const Facet& a, const Facet& b) { return a.sorted < b.sorted; });
  facets = std::move(ordered);
}

// facets of one tetrahedron only, in ascending order of their sorted corners
std::vector<Facet> single_facets(const std::vector<Tet>& tets) {
  std::vector<Facet> all;
  all.reserve(4 * tets.size());
  for (const Tet& t : tets) {
    if (t[0] < 0) continue;
    for (const std::array<Index, 3>& f :
         {std::array<Index, 3>{t[1], t[2], t[3]}, std::array<Index, 3>{t[0], t[3], t[2]},
          std::array<Index, 3>{t[0], t[1], t[3]}, std::array<Index, 3>{t[0], t[2], t[1]}}) {
      std::array<Index, 3> sorted = f;
      std::sort(sorted.begin(), sorted.end());
      all.push_back({sorted, f});
    }
  }
  update_ordered(all);
  std::vector<Facet> single;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool with_next = i + 1 < all.size() && all[i].sorted == all[i + 1].sorted;
    if (with_next) {
      ++i;
    } else {
      single.push_back(all[i]);
    }
  }
  return single;
}

FacetTag tag_of(const TetGrid& grid, const std::array<Index, 3>& facet) {
  bool first = false, second = false, band = false;
  for (const Index v : facet) {
    const NodeKind kind = grid.kinds[at(v)];
    first = first || on_first_face(kind);
    second = second || on_second_face(kind);
    band = band || kind == NodeKind::rim_band;
  }
  if (band || first == second) return FacetTag::rim;
  return first ? FacetTag::bone_side : FacetTag::articular_side;
}

}  // namespace

Triangles boundary_of(const TetGrid& grid) {
  const std::vector<Facet> facets = single_facets(grid.tets);
  Triangles result(static_cast<Eigen::Index>(facets.size()), 3);
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      result(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = facets[f].outward[k];
  return result;
}

TriMesh boundary_surface(const TetGrid& grid) {
  TriMesh surface;
  surface.points.resize(static_cast<Index>(grid.x.size()), 3);
  for (std::size_t v = 0; v < grid.x.size(); ++v)
    surface.points.row(static_cast<Index>(v)) = grid.x[v];
  surface.triangles = boundary_of(grid);
  return surface;
}

TetMesh to_tet_mesh(const TetGrid& grid) {
  std::vector<Index> number(grid.x.size(), -1);
  for (const Tet& t : grid.tets) {
    if (t[0] < 0) continue;
    for (const Index v : t) number[at(v)] = 0;
  }
  Index count = 0;
  for (Index& n : number) {
    if (n == 0) n = count++;
  }
  TetMesh mesh;
  mesh.points.resize(count, 3);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] >= 0) mesh.points.row(number[v]) = grid.x[v];
  }
  mesh.tets.resize(grid.n_living(), 4);
  Eigen::Index row = 0;
  for (const Tet& t : grid.tets) {
    if (t[0] < 0) continue;
    for (int k = 0; k < 4; ++k) mesh.tets(row, k) = number[at(t[static_cast<std::size_t>(k)])];
    ++row;
  }
  const std::vector<Facet> facets = single_facets(grid.tets);
  mesh.facets.resize(static_cast<Eigen::Index>(facets.size()), 3);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.facets(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) =
          number[at(facets[f].outward[k])];
    }
    mesh.facet_tags.push_back(tag_of(grid, facets[f].outward));
  }
  return mesh;
}

}  // namespace coxa::meshing
