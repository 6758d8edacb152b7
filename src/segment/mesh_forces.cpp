#include <coxa/segment/mesh_forces.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace coxa::segment {
namespace {

auto at(const VecX& x, Index particle) { return x.segment<3>(3 * particle); }

}  // namespace

void TargetForce::prepare(Points targets, const VecX& stiffness, const Points& normals,
                          double tangential) {
  COXA_ASSERT(targets.rows() == stiffness.size() && normals.rows() == targets.rows());
  targets_ = std::move(targets);
  stiffness_.resize(static_cast<std::size_t>(stiffness.size()));
  for (Index i = 0; i < stiffness.size(); ++i) {
    const Vec3 n = normals.row(i).transpose();
    stiffness_[static_cast<std::size_t>(i)] =
        stiffness[i] * (tangential * Mat3::Identity() + (1.0 - tangential) * n * n.transpose());
  }
}

void TargetForce::add_force(const VecX& x, const VecX&, VecX& force) const {
  for (Index i = 0; i < static_cast<Index>(stiffness_.size()); ++i) {
    const Vec3 away = at(x, first_ + i) - targets_.row(i).transpose();
    force.segment<3>(3 * (first_ + i)) -= stiffness_[static_cast<std::size_t>(i)] * away;
  }
}

void TargetForce::add_jacobian(const VecX&, const VecX&, double stiffness_factor, double,
                               solve::BlockMatrix& A) const {
  for (Index i = 0; i < static_cast<Index>(stiffness_.size()); ++i) {
    A.at(first_ + i, first_ + i) += stiffness_factor * stiffness_[static_cast<std::size_t>(i)];
  }
}

double TargetForce::energy(const VecX& x) const {
  double sum = 0.0;
  for (Index i = 0; i < static_cast<Index>(stiffness_.size()); ++i) {
    const Vec3 away = at(x, first_ + i) - targets_.row(i).transpose();
    sum += 0.5 * away.dot(stiffness_[static_cast<std::size_t>(i)] * away);
  }
  return sum;
}

SimplexForce::SimplexForce(Index first, Triangles neighbours)
    : first_(first), neighbours_(std::move(neighbours)) {}

void SimplexForce::prepare(Points metric, Points offsets, double stiffness) {
  COXA_ASSERT(metric.rows() == neighbours_.rows() && offsets.rows() == neighbours_.rows());
  metric_ = std::move(metric);
  offsets_ = std::move(offsets);
  stiffness_ = stiffness;
}

std::vector<std::pair<Index, Index>> SimplexForce::pattern() const {
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(static_cast<std::size_t>(neighbours_.rows()) * 16);
  for (Index v = 0; v < neighbours_.rows(); ++v) {
    const std::array<Index, 4> group = {v, neighbours_(v, 0), neighbours_(v, 1), neighbours_(v, 2)};
    for (const Index a : group) {
      for (const Index b : group) pairs.emplace_back(first_ + a, first_ + b);
    }
  }
  return pairs;
}

Vec3 SimplexForce::residual(const VecX& x, Index v) const {
  Vec3 r = at(x, first_ + v) - offsets_.row(v).transpose();
  for (int k = 0; k < 3; ++k) r -= metric_(v, k) * at(x, first_ + neighbours_(v, k));
  return r;
}

void SimplexForce::add_force(const VecX& x, const VecX&, VecX& force) const {
  for (Index v = 0; v < neighbours_.rows(); ++v) {
    const Vec3 pull = stiffness_ * residual(x, v);
    force.segment<3>(3 * (first_ + v)) -= pull;
    for (int k = 0; k < 3; ++k) {
      force.segment<3>(3 * (first_ + neighbours_(v, k))) += metric_(v, k) * pull;
    }
  }
}

void SimplexForce::add_jacobian(const VecX&, const VecX&, double stiffness_factor, double,
                                solve::BlockMatrix& A) const {
  const double factor = stiffness_factor * stiffness_;
  for (Index v = 0; v < neighbours_.rows(); ++v) {
    const std::array<Index, 4> group = {v, neighbours_(v, 0), neighbours_(v, 1), neighbours_(v, 2)};
    const std::array<double, 4> weight = {1.0, -metric_(v, 0), -metric_(v, 1), -metric_(v, 2)};
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < 4; ++b) {
        A.at(first_ + group[a], first_ + group[b]).diagonal().array() +=
            factor * weight[a] * weight[b];
      }
    }
  }
}

double SimplexForce::energy(const VecX& x) const {
  double sum = 0.0;
  for (Index v = 0; v < neighbours_.rows(); ++v) sum += residual(x, v).squaredNorm();
  return 0.5 * stiffness_ * sum;
}

Vec3 position_from_angle(const Vec3& metric, double phi, double height, const Vec3& A,
                         const Vec3& B, const Vec3& C) {
  const Vec3 foot = metric[0] * A + metric[1] * B + metric[2] * C;
  const Vec3 ab = B - A, ac = C - A;
  const Vec3 cross = ab.cross(ac);
  const double twice_area = cross.norm();
  if (twice_area < 1e-12) return foot;
  const Vec3 normal = cross / twice_area;
  const double r = ab.norm() * ac.norm() * (C - B).norm() / (2.0 * twice_area);
  const Vec3 to_centre = (ac.squaredNorm() * cross.cross(ab) + ab.squaredNorm() * ac.cross(cross)) /
                         (2.0 * twice_area * twice_area);
  const double d = (foot - A - to_centre).norm();
  if (d >= r) return foot + height * normal;
  const double slope = (r * r - d * d) * std::tan(phi);
  const double sign = std::abs(phi) < 0.5 * kPi ? 1.0 : -1.0;
  const double L = slope / (sign * std::sqrt(r * r + slope * std::tan(phi)) + r);
  return foot + L * normal;
}

}  // namespace coxa::segment
