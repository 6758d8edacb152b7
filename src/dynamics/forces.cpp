#include <coxa/dynamics/forces.h>

#include <coxa/core/error.h>

#include <cmath>

namespace coxa::dynamics {
namespace {

/// A spring as it stands: unit vector from a to b, length, and whether it pulls or pushes at all.
struct Line {
  Vec3 direction;
  double length;
  bool slack;
};

Line line_of(const Spring& spring, const VecX& x) {
  const Vec3 d = x.segment<3>(3 * spring.b) - x.segment<3>(3 * spring.a);
  const double length = d.norm();
  const Vec3 direction = length > 0.0 ? Vec3(d / length) : Vec3::Zero();
  const bool slack = spring.mode == Spring::Mode::tension_only && length <= spring.rest_length;
  return {direction, length, slack};
}

void add_pair(const Spring& spring, const Mat3& block, solve::BlockMatrix& A) {
  A.at(spring.a, spring.a) += block;
  A.at(spring.b, spring.b) += block;
  A.at(spring.a, spring.b) -= block;
  A.at(spring.b, spring.a) -= block;
}

}  // namespace

void ConstantForce::add_force(const VecX&, const VecX&, VecX& force) const { force += force_; }

double ConstantForce::energy(const VecX& x) const { return -force_.dot(x); }

SpringForce::SpringForce(std::vector<Spring> springs) : springs_(std::move(springs)) {
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    const Spring& s = springs_[k];
    require(s.a >= 0 && s.b >= 0 && s.a != s.b, "spring ", k, " joins particles ", s.a, " and ",
            s.b);
    require(s.rest_length >= 0.0 && s.stiffness >= 0.0 && s.damping >= 0.0, "spring ", k,
            " has a negative rest length, stiffness or damping");
  }
}

std::vector<std::pair<Index, Index>> SpringForce::pattern() const {
  std::vector<std::pair<Index, Index>> pairs;
  for (const Spring& s : springs_) {
    pairs.emplace_back(s.a, s.b);
    pairs.emplace_back(s.b, s.a);
  }
  return pairs;
}

double SpringForce::tension(std::size_t k, const VecX& x) const {
  const Line line = line_of(springs_.at(k), x);
  return line.slack ? 0.0 : springs_[k].stiffness * (line.length - springs_[k].rest_length);
}

void SpringForce::add_force(const VecX& x, const VecX& v, VecX& force) const {
  for (const Spring& s : springs_) {
    const Line line = line_of(s, x);
    if (line.slack) continue;
    const Vec3 closing = v.segment<3>(3 * s.b) - v.segment<3>(3 * s.a);
    const Vec3 pull =
        (s.stiffness * (line.length - s.rest_length) + s.damping * line.direction.dot(closing)) *
        line.direction;
    force.segment<3>(3 * s.a) += pull;
    force.segment<3>(3 * s.b) -= pull;
  }
}

void SpringForce::add_jacobian(const VecX& x, const VecX& v, double stiffness_factor,
                               double damping_factor, solve::BlockMatrix& A) const {
  for (const Spring& s : springs_) {
    const Line line = line_of(s, x);
    if (line.slack || line.length == 0.0) continue;
    const Mat3 along = line.direction * line.direction.transpose();
    const Mat3 across = (Mat3::Identity() - along) / line.length;
    Mat3 block = damping_factor * s.damping * along;
    if (stiffness_factor != 0.0) {
      // the damper's force turns with the line; its part across stays out, it is not symmetric
      block += stiffness_factor * s.stiffness * (along + (line.length - s.rest_length) * across);
      const Vec3 closing = v.segment<3>(3 * s.b) - v.segment<3>(3 * s.a);
      block += stiffness_factor * s.damping * line.direction.dot(closing) * across;
    }
    add_pair(s, block, A);
  }
}

double SpringForce::energy(const VecX& x) const {
  double sum = 0.0;
  for (const Spring& s : springs_) {
    const Line line = line_of(s, x);
    if (!line.slack)
      sum += 0.5 * s.stiffness * (line.length - s.rest_length) * (line.length - s.rest_length);
  }
  return sum;
}

MassDamping::MassDamping(VecX mass, double coefficient)
    : mass_(std::move(mass)), coefficient_(coefficient) {
  require(coefficient >= 0.0, "the damping coefficient must not be negative, got ", coefficient);
}

void MassDamping::add_force(const VecX&, const VecX& v, VecX& force) const {
  for (Eigen::Index i = 0; i < mass_.size(); ++i)
    force.segment<3>(3 * i) -= coefficient_ * mass_[i] * v.segment<3>(3 * i);
}

void MassDamping::add_jacobian(const VecX&, const VecX&, double, double damping_factor,
                               solve::BlockMatrix& A) const {
  if (damping_factor == 0.0) return;
  for (Index i = 0; i < static_cast<Index>(mass_.size()); ++i)
    A.at(i, i).diagonal().array() += damping_factor * coefficient_ * mass_[i];
}

}  // namespace coxa::dynamics
