#include "march.h"

#include <coxa/geom/fits.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace coxa::joint {

double March::sub_step(const BonePose& from, const BonePose& to) const {
  const double angle = rotation_vector(to.R * from.R.transpose()).norm();
  const double way = (to.shift - from.shift).norm();
  const double steps = std::ceil(
      std::max(angle / options_.max_rotation_step, way / options_.max_translation_step) - 1e-9);
  return 1.0 / std::max(1.0, steps);
}

/// Mean of the forces at both ends times the way of every held femoral node (trapezium rule).
double March::work_between(const HipState& before, const HipState& after, const VecX& first,
                           const VecX& last) const {
  const Vec3 shift = after.x.segment<3>(3 * system_.translation()) -
                     before.x.segment<3>(3 * system_.translation());
  double work = 0.0;
  for (const Index i : system_.femur_nodes()) {
    const Vec3 way = after.x.segment<3>(3 * i) - before.x.segment<3>(3 * i) + shift;
    work -= 0.5 * way.dot(first.segment<3>(3 * i) + last.segment<3>(3 * i));
  }
  return work;
}

Settling March::advance(HipState& state, const BonePose& target, const Vec3& force,
                        const Monitor& monitor) {
  const HipState start = state;
  const double work_at_start = work_;
  double done = 0.0, step = sub_step(start.pose, target);
  int iterations = 0, cutbacks = 0;
  VecX forces = equilibrium_.node_forces(state);
  while (true) {
    const double next = done + step > 1.0 - 1e-9 ? 1.0 : done + step;
    HipState trial = state;
    trial.contact.begin_slip(state.x);
    predictor_.carry(system_, trial, between(start.pose, target, next));
    const auto exactness = next == 1.0 ? Exactness::result : Exactness::on_the_way;
    Settling settling = equilibrium_.settle(trial, force, exactness, monitor);
    iterations += settling.iterations;
    settling.iterations = iterations;
    if (settling.converged) {
      VecX forces_there = equilibrium_.node_forces(trial);
      work_ += work_between(state, trial, forces, forces_there);
      forces = std::move(forces_there);
      predictor_.note(state);
      state = std::move(trial);
      done = next;
      if (done == 1.0) return settling;
    } else if (cutbacks++ < options_.max_cutbacks) {
      step *= 0.5;
      predictor_.forget();
    } else {
      state = start;
      predictor_.forget();
      work_ = work_at_start;
      return settling;
    }
  }
}

Settling March::start_anew(HipState& state, const BonePose& target, const Vec3& force,
                           const Monitor& monitor) {
  HipState fresh{system_.reference(), target, state.contact};
  system_.update_pose(fresh.x, {}, target);
  fresh.x.segment<3>(3 * system_.translation()) = state.x.segment<3>(3 * system_.translation());
  Settling settling;
  settling.reason = equilibrium_.seat(fresh, force);
  if (!settling.reason.empty()) return settling;
  settling = equilibrium_.settle(fresh, force, Exactness::result, monitor);
  if (!settling.converged) return settling;
  const VecX before = equilibrium_.node_forces(state);
  work_ += work_between(state, fresh, before, equilibrium_.node_forces(fresh));
  predictor_.forget();
  state = std::move(fresh);
  return settling;
}

}  // namespace coxa::joint
