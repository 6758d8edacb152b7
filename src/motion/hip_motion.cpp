#include <coxa/motion/hip_motion.h>

#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

Mat3 about_x(double a) {
  Mat3 R;
  R << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a);
  return R;
}
Mat3 about_y(double a) {
  Mat3 R;
  R << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a);
  return R;
}
Mat3 about_z(double a) {
  Mat3 R;
  R << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
  return R;
}

double sign_of(Side side) { return side == Side::right ? 1.0 : -1.0; }

}  // namespace

// Wu et al. 2002: e1 = z of the pelvis, e2 floating, e3 = y of the femur; z points right on both
// sides, so that adduction and internal rotation of a left hip turn the other way round.
Mat3 rotation_from_angles(const HipAngles& angles, Side side) {
  const double s = sign_of(side);
  return about_z(angles.flexion) * about_x(s * angles.adduction) *
         about_y(s * angles.internal_rotation);
}

HipAngles angles_from_rotation(const Mat3& R, Side side) {
  const double s = sign_of(side);
  return {.flexion = std::atan2(-R(0, 1), R(1, 1)),
          .adduction = s * std::asin(std::clamp(R(2, 1), -1.0, 1.0)),
          .internal_rotation = s * std::atan2(-R(2, 0), R(2, 2))};
}

}  // namespace coxa::motion
