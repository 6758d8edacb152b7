#include "cut_samples.h"

#include <coxa/core/parallel.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace coxa::collide {
namespace {

using Vec2 = Eigen::Vector2d;
using Polygon = std::vector<Vec2>;

// pieces smaller than this share of their facet carry nothing, only rounding
constexpr double kLeastPiece = 1e-12;

/// A slave facet as an affine frame: a point is a + X u + Y v + height n.
struct Facet {
  Vec3 a, u, v, n;
  double double_area;

  /// Facet coordinates of a point, and its height.
  std::pair<Vec2, double> coordinates(const Vec3& p) const {
    const Vec3 d = p - a;
    return {Vec2(d.cross(v).dot(n), u.cross(d).dot(n)) / double_area, d.dot(n)};
  }
};

/// The part of a convex polygon where `side` is not negative; `side` is affine.
template <typename Side>
Polygon clipped(const Polygon& polygon, const Side& side) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double at_p = side(p), at_q = side(q);
    if (at_p >= 0.0) kept.push_back(p);
    if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) {
      kept.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
  }
  return kept;
}

/// Where a triangle of the other surface covers the facet, in facet coordinates.
Polygon cover(const Facet& facet, const std::array<Vec3, 3>& triangle, double search_distance) {
  if ((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).dot(facet.n) >= 0.0) return {};
  Polygon polygon;
  double nearest = kInfinity;
  for (const Vec3& corner : triangle) {
    const auto [place, height] = facet.coordinates(corner);
    polygon.push_back(place);
    nearest = std::min(nearest, std::abs(height));
  }
  if (nearest > search_distance) return {};
  polygon = clipped(polygon, [](const Vec2& p) { return p[0]; });
  polygon = clipped(polygon, [](const Vec2& p) { return p[1]; });
  return clipped(polygon, [](const Vec2& p) { return 1.0 - p[0] - p[1]; });
}

/// Three points in each triangle of the fan over a piece, exact for quadratics.
void append_samples(const Polygon& piece, Index triangle, double facet_area,
                    std::vector<ContactSample>& samples) {
  for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
    const Vec2 u = piece[k] - piece[0], v = piece[k + 1] - piece[0];
    const double share = std::abs(u[0] * v[1] - u[1] * v[0]);
    if (share < kLeastPiece) continue;
    for (const auto& [a, b] : {std::pair{1, 1}, std::pair{4, 1}, std::pair{1, 4}}) {
      const Vec2 p = piece[0] + a / 6.0 * u + b / 6.0 * v;
      samples.push_back({.triangle = triangle,
                         .barycentric = Vec3(1.0 - p[0] - p[1], p[0], p[1]),
                         .area = share * facet_area / 3.0});
    }
  }
}

}  // namespace

std::vector<ContactSample> cut_samples(const TriMesh& slave, const Points& normals,
                                       const TriangleTree& other, double search_distance) {
  std::vector<std::vector<ContactSample>> of_facet(static_cast<std::size_t>(slave.n_triangles()));
  parallel_for(slave.n_triangles(), [&](Index t) {
    const auto corner = [&](int k) { return Vec3(slave.points.row(slave.triangles(t, k))); };
    const Vec3 n = normals.row(t), reach = search_distance * n;
    const Facet facet{corner(0), corner(1) - corner(0), corner(2) - corner(0), n,
                      (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm()};
    if (!(facet.double_area > 0.0)) return;
    Vec3 low = Vec3::Constant(kInfinity), high = -low;
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(corner(k) - reach).cwiseMin(corner(k) + reach);
      high = high.cwiseMax(corner(k) - reach).cwiseMax(corner(k) + reach);
    }
    for (const Index o : other.overlapping(low, high)) {
      std::array<Vec3, 3> triangle;
      for (int k = 0; k < 3; ++k)
        triangle[static_cast<std::size_t>(k)] = other.points().row(other.triangles()(o, k));
      append_samples(cover(facet, triangle, search_distance), t, 0.5 * facet.double_area,
                     of_facet[static_cast<std::size_t>(t)]);
    }
  });
  std::vector<ContactSample> samples;
  for (const auto& some : of_facet) samples.insert(samples.end(), some.begin(), some.end());
  return samples;
}

}  // namespace coxa::collide
