#pragma once

#include "equilibrium.h"
#include "predictor.h"

namespace coxa::joint {

/// Takes the hip along the movement in sub-steps, and adds up what the femur works on the way.
class March {
 public:
  /// @note keeps references to all three, which must outlive it
  March(const HipSystem& system, LoadMode mode, const JointOptions& options)
      : system_(system), options_(options), equilibrium_(system, mode, options) {}

  /// Brings `state` to a pose under a force; a failure leaves it as it was. Sub-steps no longer
  /// than the options say; one that fails is halved.
  Settling advance(HipState& state, const BonePose& target, const Vec3& force,
                   const Monitor& monitor);

  /// Brings `state` to a pose without the way there: undeformed, seated anew. What equilibrium
  /// there is without friction does not depend on the way. A failure leaves it as it was.
  Settling start_anew(HipState& state, const BonePose& target, const Vec3& force,
                      const Monitor& monitor);

  Equilibrium& equilibrium() { return equilibrium_; }
  double work() const { return work_; }  ///< N·mm, of the femur's bone side on the cartilage

 private:
  double sub_step(const BonePose& from, const BonePose& to) const;
  double work_between(const HipState& before, const HipState& after, const VecX& first,
                      const VecX& last) const;

  const HipSystem& system_;
  const JointOptions& options_;
  Equilibrium equilibrium_;
  Predictor predictor_;
  double work_ = 0.0;
};

}  // namespace coxa::joint
