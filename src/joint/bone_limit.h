#pragma once

#include <coxa/collide/rigid_pair.h>
#include <coxa/joint/joint_model.h>
#include <coxa/joint/joint_result.h>

#include <optional>

namespace coxa::joint {

/// Watches the distance of femur and hip bone, or labrum, outside the cartilage-covered head.
class BoneLimit {
 public:
  /// Without bone surfaces there is no limit: every clearance is NaN.
  explicit BoneLimit(const JointModel& model) : BoneLimit(model, model.hip_bone) {}
  /// @param fixed  what the femur may meet, rigid with the hip bone; empty: nothing
  BoneLimit(const JointModel& model, const TriMesh& fixed);

  /// Least distance of the two at a pose, mm, negative overlap; NaN where they are not near.
  double clearance(const RigidTransform& X_II) const;
  /// Where the two are nearest, looked for up to `reach` mm; nullopt where they are not near.
  std::optional<collide::Clearance> nearest(const RigidTransform& X_II, double reach) const;
  /// Where on the way from `apart` to `together` (which overlaps) the two first touch.
  collide::FirstContact first_touch(const std::function<RigidTransform(double)>& pose_at) const;

 private:
  std::optional<collide::RigidPair> pair_;
};

/// Per femur vertex whether contact there is a bony limit: not on the head, that is not within 2 mm
/// of the femoral cartilage and not on the head's sphere within 60 degrees of the cartilage's
/// middle (the fovea).
std::vector<bool> limit_vertices(const JointModel& model);

}  // namespace coxa::joint
