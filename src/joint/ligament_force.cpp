#include "ligament_force.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coxa::joint {
namespace {

LigamentPath straight(const Vec3& way) {
  const double length = way.norm();
  const Vec3 along = way / length;
  return {length, along, (Mat3::Identity() - along * along.transpose()) / length};
}

}  // namespace

LigamentPath ligament_path(const Vec3& origin, const Vec3& insertion, const Vec3& centre,
                           double radius) {
  const Vec3 a = origin - centre, b = insertion - centre;
  const double s = a.norm(), r = radius;
  if (r == 0.0) return straight(a - b);
  const Vec3 out = a / s;
  const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
  const double around = turn - std::acos(r / s) - std::acos(r / b.norm());
  if (around <= 0.0) return straight(a - b);
  // length = sqrt(s^2 - r^2) + r around + sqrt(|b|^2 - r^2), by s and the turn
  const double free = std::sqrt(s * s - r * r);
  const Vec3 aside = (std::cos(turn) * out - b.normalized()) / std::max(std::sin(turn), 1e-12);
  const Vec3 across = out.cross(aside);
  const Vec3 in_plane = (r * out - free * aside) / s;
  const double sideways = (free + r / std::tan(turn)) / (s * s);
  return {free + r * around + std::sqrt(b.squaredNorm() - r * r), (free * out + r * aside) / s,
          in_plane * in_plane.transpose() / free +
              std::max(0.0, sideways) * across * across.transpose()};
}

double image_length(const Ligament& ligament, const Vec3& centre) {
  return ligament_path(ligament.origin, ligament.insertion, centre, ligament.wrap_radius).length;
}

LigamentPath LigamentForce::path(std::size_t k, const VecX& x) const {
  const Vec3 t = x.segment<3>(3 * translation_);
  const Index insertion = insertions_ + static_cast<Index>(k);
  return ligament_path(ligaments_[k].origin - t, x.segment<3>(3 * insertion),
                       x.segment<3>(3 * centre_), ligaments_[k].wrap_radius);
}

double LigamentForce::stretch(std::size_t k, double length) const {
  return std::max(0.0, length - ligaments_[k].slack_length);
}

void LigamentForce::add_force(const VecX& x, const VecX&, VecX& force) const {
  force.segment<3>(3 * translation_) += pull(x);
}

void LigamentForce::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                 solve::BlockMatrix& A) const {
  A.at(translation_, translation_) += stiffness_factor * stiffness(x);
}

double LigamentForce::energy(const VecX& x) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < size(); ++k) {
    const double longer = stretch(k, path(k, x).length);
    sum += 0.5 * ligaments_[k].stiffness * longer * longer;
  }
  return sum;
}

VecX LigamentForce::tensions(const VecX& x) const {
  VecX tensions(static_cast<Eigen::Index>(size()));
  for (std::size_t k = 0; k < size(); ++k) {
    tensions[static_cast<Eigen::Index>(k)] =
        ligaments_[k].stiffness * stretch(k, path(k, x).length);
  }
  return tensions;
}

Vec3 LigamentForce::pull(const VecX& x) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < size(); ++k) {
    const LigamentPath way = path(k, x);
    sum += ligaments_[k].stiffness * stretch(k, way.length) * way.towards_origin;
  }
  return sum;
}

Mat3 LigamentForce::stiffness(const VecX& x) const {
  Mat3 sum = Mat3::Zero();
  for (std::size_t k = 0; k < size(); ++k) {
    const LigamentPath way = path(k, x);
    const double longer = stretch(k, way.length);
    if (longer == 0.0) continue;
    sum += ligaments_[k].stiffness *
           (way.towards_origin * way.towards_origin.transpose() + longer * way.curvature);
  }
  return sum;
}

}  // namespace coxa::joint
