#pragma once

#include <coxa/core/types.h>

#include <Eigen/Geometry>

#include <cmath>

namespace coxa {

/// Clock face of a socket, seen from the side so that 12 is superior and 3 anterior: as drawn on a
/// right hip, mirrored on a left one.
struct ClockFace {
  Vec3 centre = Vec3::Zero();   ///< mm
  Vec3 axis = Vec3::UnitZ();    ///< unit, out of the socket
  Vec3 twelve = Vec3::UnitY();  ///< unit, across the axis
  Vec3 three = Vec3::UnitX();   ///< unit, across both

  /// Hour in [0, 12) of the direction from the centre to p; 0 is twelve o'clock.
  double hour(const Vec3& p) const {
    const Vec3 d = p - centre;
    const double turn = std::atan2(d.dot(three), d.dot(twelve)) / (2.0 * kPi);
    return 12.0 * (turn < 0.0 ? turn + 1.0 : turn);
  }
  /// Hour rounded to 0..11 (0 is twelve o'clock): sector h reaches half an hour to both sides.
  static int sector(double hour) { return static_cast<int>(std::lround(hour)) % 12; }
  int sector(const Vec3& p) const { return sector(hour(p)); }
};

/// The clock face about `axis` (out of the socket) with twelve towards `superior`, three towards
/// `anterior`.
inline ClockFace make_clock_face(const Vec3& centre, const Vec3& axis, const Vec3& superior,
                                 const Vec3& anterior) {
  ClockFace face;
  face.centre = centre;
  face.axis = axis.normalized();
  const Vec3 up = superior - superior.dot(face.axis) * face.axis;
  const Vec3 front = anterior - anterior.dot(face.axis) * face.axis;
  // a socket that opens straight down or up has no superior side: anterior alone sets the clock
  const bool upright = up.norm() > 1e-6 * superior.norm();
  face.twelve = upright ? up.normalized() : front.cross(face.axis).normalized();
  face.three = face.twelve.cross(face.axis);
  if (face.three.dot(anterior) < 0.0) face.three = -face.three;
  return face;
}

}  // namespace coxa
