#include "element_shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::meshing {
namespace {

// sum of squared edges^(3/2) over six times the volume, for the regular tetrahedron: 6^(3/2)
// sqrt(2)
const double kRegular = std::pow(6.0, 1.5) * std::sqrt(2.0);

double squared_edges(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).squaredNorm() + (c - a).squaredNorm() + (d - a).squaredNorm() +
         (c - b).squaredNorm() + (d - c).squaredNorm() + (b - d).squaredNorm();
}

double softened(double volume, double softening) {
  if (softening <= 0.0) return volume;
  return 0.5 * (volume + std::sqrt(volume * volume + 4.0 * softening * softening));
}

}  // namespace

double shape_energy(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double softening) {
  const double volume = softened((b - a).cross(c - a).dot(d - a), softening);
  if (!(volume > 0.0)) return kInfinity;
  const double s = squared_edges(a, b, c, d);
  return s * std::sqrt(s) / (kRegular * volume);
}

ShapeDerivatives shape_derivatives(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                   double softening) {
  ShapeDerivatives result;
  const double plain = (b - a).cross(c - a).dot(d - a);
  const double volume = softened(plain, softening);
  if (!(volume > 0.0)) return result;
  const double s = squared_edges(a, b, c, d);
  const Vec3 ds = 2.0 * (3.0 * a - b - c - d);
  // the volume is linear in a; its softening has slope volume / sqrt(plain² + 4 softening²)
  const double slope =
      softening > 0.0 ? volume / std::sqrt(plain * plain + 4.0 * softening * softening) : 1.0;
  const Vec3 dv = -slope * (c - b).cross(d - b);
  const Vec3 g = 1.5 * ds / s - dv / volume;
  result.energy = s * std::sqrt(s) / (kRegular * volume);
  result.gradient = result.energy * g;
  result.hessian = result.energy *
                   (g * g.transpose() + 9.0 / s * Mat3::Identity() -
                    1.5 / (s * s) * ds * ds.transpose() + dv * dv.transpose() / (volume * volume));
  return result;
}

double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double volume = u.cross(v).dot(w);
  if (!(volume > 0.0)) return 0.0;
  const double areas =
      u.cross(v).norm() + v.cross(w).norm() + w.cross(u).norm() + (v - u).cross(w - u).norm();
  const double circum =
      (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v))
          .norm() /
      (2.0 * volume);
  return 3.0 * (volume / areas) / circum;
}

DihedralRange dihedral_range(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> n = {
      (c - b).cross(d - b).normalized(), (d - a).cross(c - a).normalized(),
      (b - a).cross(d - a).normalized(), (c - a).cross(b - a).normalized()};
  DihedralRange range{kPi, 0.0};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double angle = std::acos(std::clamp(-n[i].dot(n[j]), -1.0, 1.0));
      range.smallest = std::min(range.smallest, angle);
      range.largest = std::max(range.largest, angle);
    }
  }
  return range;
}

}  // namespace coxa::meshing
