#pragma once

#include <coxa/joint/joint_model.h>
#include <coxa/motion/hip_motion.h>

namespace coxa::test {

/// n frames of even steps from rest to the given angles; the joint centre stays.
inline motion::HipMotion movement_to(const motion::HipAngles& end, Index n,
                                     Side side = Side::right) {
  motion::HipMotion motion;
  for (Index k = 0; k < n; ++k) {
    const double s = n == 1 ? 1.0 : static_cast<double>(k) / (n - 1);
    const motion::HipAngles angles{s * end.flexion, s * end.adduction, s * end.internal_rotation};
    motion.time.push_back(s);
    motion.angles.push_back(angles);
    motion.X_PF.push_back({motion::rotation_from_angles(angles, side), Vec3::Zero()});
  }
  return motion;
}

}  // namespace coxa::test
