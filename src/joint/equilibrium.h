#pragma once

#include <coxa/core/monitor.h>
#include <coxa/joint/simulate.h>

#include <optional>

#include "hip_system.h"
#include "hip_tangent.h"

namespace coxa::joint {

/// Positions, pose and contact state of the hip: all that a sub-step changes.
struct HipState {
  VecX x;
  BonePose pose;
  HipContact contact;
};

/// Elastic forces and energy at the positions last asked for: a round of settling asks several
/// times for the same ones.
class ElasticState {
 public:
  /// @note keeps a reference to the system, which must outlive it
  explicit ElasticState(const HipSystem& system) : system_(system) {}
  const VecX& force(const VecX& x) { return update(x), force_; }  ///< N, on all particles
  double energy(const VecX& x) { return update(x), energy_; }     ///< N·mm

 private:
  void update(const VecX& x);

  const HipSystem& system_;
  VecX x_, force_;
  double energy_ = 0.0;
};

/// How well a state is settled, and what it cost.
struct Settling {
  bool converged = false;
  std::string reason;
  double residual = 0.0;     ///< of the free nodes, relative to the joint force
  double imbalance = 0.0;    ///< net force left on a cartilage, relative to the joint force
  double penetration = 0.0;  ///< mm
  int iterations = 0;        ///< Newton steps
};

/// How exact a settling must be.
enum class Exactness {
  by_hand,     ///< a step led by hand: pairs are searched for once, the next step takes up what is
               ///< left
  on_the_way,  ///< a state only passed through
  result
};

/// Static equilibrium of the hip at a bone pose under a joint force (or with the translation held).
class Equilibrium {
 public:
  /// @note keeps references to system and options, which must outlive it
  Equilibrium(const HipSystem& system, LoadMode mode, const JointOptions& options);

  /// Places the femur where rigid bones with springy cartilage would balance `force`: the start of
  /// everything.
  /// @returns why it cannot, or empty
  std::string seat(HipState& state, const Vec3& force) const;
  /// Finds the equilibrium from the positions in `state`.
  Settling settle(HipState& state, const Vec3& force, Exactness exactness, const Monitor& monitor);

  /// Forces on all particles at a state, held ones included, without the joint force: N.
  VecX node_forces(const HipState& state);
  double elastic_energy(const HipState& state) { return elastic_.energy(state.x); }  ///< N·mm
  /// Forces of free particles at the state, N, zero at held ones.
  VecX residual(const HipState& state, const Vec3& force);
  /// Size against which residuals count: the joint force, or the contact force of a prescribed
  /// pose, N.
  double reference_force(const HipState& state, const Vec3& force) const;

 private:
  struct Limits {
    double residual, imbalance, penetration;
  };
  Settling judge(const HipState& state, const Vec3& force, const Limits& limits);
  VecX residual(const VecX& x, const HipContact& contact, const Vec3& force);
  double net_force(const VecX& residual) const;
  SolveReport relax(HipState& state, const Vec3& force, double tolerance, double reference);
  std::string touch(HipState& state, const Vec3& direction) const;

  const HipSystem& system_;
  LoadMode mode_;
  const JointOptions& options_;
  std::vector<bool> free_;
  ElasticState elastic_;
  HipTangent tangent_;
  int tangent_age_ = 0;  ///< linear solves since the elastic tangent was taken
};

}  // namespace coxa::joint
