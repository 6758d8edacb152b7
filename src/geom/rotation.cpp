#include <coxa/geom/fits.h>

#include <Eigen/Geometry>

#include <cmath>

namespace coxa {

Mat3 rotation_from_vector(const Vec3& w) {
  const double angle = w.norm();
  // below the limit the series of sin(x)/x and (1 - cos x)/x² end after two terms to rounding
  const bool small = angle < 1e-4;
  const double s = small ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  const double half = small ? 1.0 - angle * angle / 24.0 : std::sin(0.5 * angle) / (0.5 * angle);
  Mat3 K;
  K << 0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0;
  return Mat3::Identity() + s * K + 0.5 * half * half * (K * K);
}

Vec3 rotation_vector(const Mat3& R) {
  // by the unit quaternion, which is accurate at every angle (Shepperd 1978)
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return (2.0 * std::atan2(sine, q.w()) / sine) * q.vec();
}

}  // namespace coxa
