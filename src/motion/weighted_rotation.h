#pragma once

#include "thigh_observations.h"

namespace coxa::motion {

/// Rotation of a thigh about the joint centre from markers whose errors have a known covariance.
///
/// With R = R0 exp(delta) the residual R0^T y - x is J delta + error, J = -[x]×; the generalised
/// least-squares delta is gain · residual, and R solves J^T V^-1 (R^T y - x) = 0.
class WeightedRotation {
 public:
  /// @param x           K×3, mm, femur axes from the joint centre, not all on one line through it
  /// @param covariance  K×K per axis, positive definite
  WeightedRotation(const Points& x, const AxisCovariance& covariance);
  /// From weights, which may be singular: those of a fit whose translation is free are.
  static WeightedRotation from_weights(const Points& x, AxisCovariance weights);

  /// The rotation for one frame, from a start within some 60 degrees.
  /// @param y  K×3, mm, pelvis axes from the joint centre
  Mat3 solve(const Points& y, const Mat3& start) const;

  const AxisCovariance& weights() const { return weights_; }
  /// 3×K per axis: rotation error (femur axes, rad) per mm of error of each marker.
  const std::array<MatX, 3>& gain() const { return gain_; }
  /// 3×3: rotation error per mm of a shift that all markers share, femur axes.
  Mat3 shift_gain() const;
  /// Covariance of the rotation error that errors of this covariance cause, rad².
  Mat3 propagated(const AxisCovariance& covariance) const;
  /// (J^T V^-1 J)^-1, rad².
  const Mat3& inverse_information() const { return inverse_information_; }

 private:
  WeightedRotation() = default;
  void set_gain();

  Points x_;
  AxisCovariance weights_;
  std::array<MatX, 3> gain_;
  Mat3 inverse_information_ = Mat3::Zero();
};

/// The derivative of all residuals along one axis by a small rotation, K×3: rows of -[x]×.
MatX rotation_derivative(const Points& x, int axis);

}  // namespace coxa::motion
