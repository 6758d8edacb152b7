#include "weighted_rotation.h"

#include <coxa/geom/cross_matrix.h>
#include <coxa/geom/fits.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <utility>

namespace coxa::motion {

AxisCovariance same_along_all_axes(const MatX& covariance) {
  return {covariance, covariance, covariance};
}

MatX rotation_derivative(const Points& x, int axis) {
  MatX J(x.rows(), 3);
  for (Eigen::Index m = 0; m < x.rows(); ++m) J.row(m) = -cross_matrix(x.row(m)).row(axis);
  return J;
}

WeightedRotation::WeightedRotation(const Points& x, const AxisCovariance& covariance) : x_(x) {
  const Eigen::Index K = x.rows();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    weights_[axis] = covariance[axis].llt().solve(MatX::Identity(K, K));
  }
  set_gain();
}

WeightedRotation WeightedRotation::from_weights(const Points& x, AxisCovariance weights) {
  WeightedRotation rotation;
  rotation.x_ = x;
  rotation.weights_ = std::move(weights);
  rotation.set_gain();
  return rotation;
}

void WeightedRotation::set_gain() {
  Mat3 information = Mat3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const MatX J = rotation_derivative(x_, axis);
    gain_[static_cast<std::size_t>(axis)] =
        J.transpose() * weights_[static_cast<std::size_t>(axis)];
    information += gain_[static_cast<std::size_t>(axis)] * J;
  }
  inverse_information_ = information.inverse();
  for (MatX& gain : gain_) gain = inverse_information_ * gain;
}

Mat3 WeightedRotation::solve(const Points& y, const Mat3& start) const {
  // J is taken at x, not at the markers' displaced places, so steps shrink by about
  // (artefact / distance from the joint), a tenth, each time
  constexpr int kMaxSteps = 60;
  constexpr double kTolerance = 1e-12;  // rad
  Mat3 R = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Points r = Points(y * R) - x_;
    Vec3 delta = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis)
      delta += gain_[static_cast<std::size_t>(axis)] * r.col(axis);
    R = R * rotation_from_vector(delta);
    if (delta.norm() < kTolerance) break;
  }
  return nearest_rotation(R);
}

Mat3 WeightedRotation::shift_gain() const {
  Mat3 gain;
  for (int axis = 0; axis < 3; ++axis)
    gain.col(axis) = gain_[static_cast<std::size_t>(axis)].rowwise().sum();
  return gain;
}

Mat3 WeightedRotation::propagated(const AxisCovariance& covariance) const {
  Mat3 sum = Mat3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += gain_[axis] * covariance[axis] * gain_[axis].transpose();
  return sum;
}

}  // namespace coxa::motion
