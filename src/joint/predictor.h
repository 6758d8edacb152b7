#pragma once

#include "equilibrium.h"

namespace coxa::joint {

/// Starts each step of a steady movement where the last one would go on to.
///
/// What the last step changed beside the bones' own movement - deformation in the bones' frames,
/// translation - is taken to go on at the same rate, as long as the movement keeps its direction.
class Predictor {
 public:
  /// Carries `state` to `target`; pairs and multipliers stay as they are.
  void carry(const HipSystem& system, HipState& state, const BonePose& target) const;
  /// Tells that a step that started at `before` has settled.
  void note(const HipState& before);
  /// Forgets the rate: after a failure, or when something else has changed than the pose.
  void forget() { x_.resize(0); }
  bool has_rate() const { return x_.size() > 0; }

 private:
  VecX x_;         ///< where the last step started; empty: nothing to go by
  BonePose from_;  ///< the pose there
};

}  // namespace coxa::joint
