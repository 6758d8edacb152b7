#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// Pose of one frame in another: `p_A = X_AB * p_B`. Rotation matrix and translation in mm.
struct RigidTransform {
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();

  Vec3 operator*(const Vec3& point) const { return R * point + p; }
  RigidTransform operator*(const RigidTransform& other) const {
    return {R * other.R, R * other.p + p};
  }
  RigidTransform inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

/// Every row of `points` (n×3, mm) mapped by X.
inline Points transformed(const Points& points, const RigidTransform& X) {
  return (points * X.R.transpose()).rowwise() + X.p.transpose();
}

}  // namespace coxa
