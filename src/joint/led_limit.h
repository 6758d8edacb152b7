#pragma once

#include <optional>

#include "bone_limit.h"

namespace coxa::joint {

/// A limit watched along a way led by hand: the places that were nearest last tell how far to look,
/// which is cheaper than looking all around and finds the same.
class LedLimit {
 public:
  /// As of `BoneLimit`.
  LedLimit(const JointModel& model, const TriMesh& fixed) : limit_(model, fixed) {}

  /// Where the two are nearest at a pose; nullopt where they are not near.
  std::optional<collide::Clearance> nearest(const RigidTransform& X_II);

 private:
  BoneLimit limit_;
  RigidTransform pose_;                     // of the last call
  std::optional<collide::Clearance> last_;  // its answer
};

}  // namespace coxa::joint
