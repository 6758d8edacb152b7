#include "led_limit.h"

#include <algorithm>

namespace coxa::joint {
namespace {

// clearances beyond tell a hand nothing yet, mm
constexpr double kLedReach = 3.0;
// overlaps that arise within a step elsewhere than at the nearest places are no deeper, mm: a step
// of a degree moves bone 60 mm from the joint centre by as much
constexpr double kNewOverlap = 1.0;

}  // namespace

std::optional<collide::Clearance> LedLimit::nearest(const RigidTransform& X_II) {
  double reach = kLedReach;
  if (last_) {
    const Vec3 moved = X_II * (pose_.inverse() * last_->moving_point);
    reach = std::min(reach, (moved - last_->fixed_point).norm() + kNewOverlap);
  }
  last_ = limit_.nearest(X_II, reach);
  pose_ = X_II;
  return last_;
}

}  // namespace coxa::joint
