#include <coxa/mesh/tet_quality.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace coxa {
namespace {

// facet k is opposite corner k, counter-clockwise from outside for positive volumes
constexpr std::array<std::array<int, 3>, 4> kFacets{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Corners {
  std::array<Vec3, 4> x;
  Corners(const Points& points, const Tets& tets, Index t) {
    for (int k = 0; k < 4; ++k) x[static_cast<std::size_t>(k)] = points.row(tets(t, k));
  }
  double volume() const { return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6.0; }
  // length: twice the facet's area
  Vec3 facet_normal(std::size_t k) const {
    const auto [a, b, c] = kFacets[k];
    const Vec3& p = x[static_cast<std::size_t>(a)];
    return (x[static_cast<std::size_t>(b)] - p).cross(x[static_cast<std::size_t>(c)] - p);
  }
};

double aspect(const Corners& tet) {
  const double volume = tet.volume();
  if (!(volume > 0.0)) return 0.0;
  double surface = 0.0;
  for (std::size_t k = 0; k < 4; ++k) surface += 0.5 * tet.facet_normal(k).norm();
  // circumradius = |a|² b×c + |b|² c×a + |c|² a×b over 12 V
  const Vec3 a = tet.x[1] - tet.x[0], b = tet.x[2] - tet.x[0], c = tet.x[3] - tet.x[0];
  const double radius =
      (a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b))
          .norm() /
      (12.0 * volume);
  return 3.0 * (3.0 * volume / surface) / radius;
}

void check(const Points& points, const Tets& tets) {
  if (tets.rows() == 0) fail(ErrorCode::bad_mesh, "the mesh has no tetrahedron");
  if (tets.minCoeff() < 0 || tets.maxCoeff() >= points.rows())
    fail(ErrorCode::bad_mesh, "a tetrahedron names vertex ",
         tets.minCoeff() < 0 ? tets.minCoeff() : tets.maxCoeff(),
         ", but vertices are numbered 0 to ", points.rows() - 1);
}

}  // namespace

VecX tet_volumes(const Points& points, const Tets& tets) {
  VecX volumes(tets.rows());
  parallel_for(tets.rows(), [&](Index t) { volumes[t] = Corners(points, tets, t).volume(); });
  return volumes;
}

VecX tet_aspects(const Points& points, const Tets& tets) {
  VecX aspects(tets.rows());
  parallel_for(tets.rows(), [&](Index t) { aspects[t] = aspect(Corners(points, tets, t)); });
  return aspects;
}

TetDihedrals tet_dihedrals(const Points& points, const Tets& tets) {
  TetDihedrals angles(tets.rows(), 6);
  parallel_for(tets.rows(), [&](Index t) {
    const Corners tet(points, tets, t);
    // the edge between corners i and j lies between the facets opposite the other two; pairs (i, j)
    // in the order 01 02 03 12 13 23 meet at the edges 23 13 12 03 02 01
    Index edge = 5;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j, --edge) {
        const Vec3 n = tet.facet_normal(i), m = tet.facet_normal(j);
        angles(t, edge) = std::atan2(n.cross(m).norm(), -n.dot(m));
      }
  });
  return angles;
}

TetQuality tet_quality(const Points& points, const Tets& tets) {
  check(points, tets);
  const VecX volumes = tet_volumes(points, tets), aspects = tet_aspects(points, tets);
  const TetDihedrals dihedrals = tet_dihedrals(points, tets);
  return {.n_tets = static_cast<Index>(tets.rows()),
          .n_inverted = static_cast<Index>((volumes.array() <= 0.0).count()),
          .volume = volumes.sum(),
          .dihedral_mean = dihedrals.mean(),
          .dihedral_min = dihedrals.minCoeff(),
          .dihedral_max = dihedrals.maxCoeff(),
          .aspect_mean = aspects.mean(),
          .aspect_p05 = percentile(aspects, 0.05),
          .aspect_min = aspects.minCoeff()};
}

Triangles boundary_facets(const Tets& tets, std::vector<Index>* owners) {
  struct TetSide {
    std::array<Index, 3> key;
    Index number;  // 4 * tetrahedron + facet
  };
  std::vector<TetSide> sides;
  sides.reserve(static_cast<std::size_t>(tets.size()));
  for (Index t = 0; t < tets.rows(); ++t)
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<Index, 3> key{};
      for (std::size_t i = 0; i < 3; ++i) key[i] = tets(t, kFacets[k][i]);
      std::sort(key.begin(), key.end());
      sides.push_back({key, 4 * t + static_cast<Index>(k)});
    }
  std::sort(sides.begin(), sides.end(), [](const TetSide& a, const TetSide& b) {
    return std::tie(a.key, a.number) < std::tie(b.key, b.number);
  });
  std::vector<Index> single;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t next = i + 1;
    while (next < sides.size() && sides[next].key == sides[i].key) ++next;
    if (next == i + 1) single.push_back(sides[i].number);
    i = next;
  }
  std::sort(single.begin(), single.end());
  Triangles facets(static_cast<Index>(single.size()), 3);
  if (owners != nullptr) owners->clear();
  for (std::size_t i = 0; i < single.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      facets(static_cast<Index>(i), static_cast<Index>(k)) =
          tets(single[i] / 4, kFacets[static_cast<std::size_t>(single[i] % 4)][k]);
    if (owners != nullptr) owners->push_back(single[i] / 4);
  }
  return facets;
}

}  // namespace coxa
