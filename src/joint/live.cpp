#include <coxa/joint/live.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include <algorithm>
#include <chrono>

#include "equilibrium.h"
#include "frame_figures.h"
#include "led_limit.h"
#include "predictor.h"

namespace coxa::joint {

JointOptions live_options() {
  JointOptions options;
  options.max_rotation_step = radians(1.0);
  options.max_newton_iterations = 10;
  options.max_contact_updates = 12;
  return options;
}

namespace {

void note_clearances(LiveHip::Step& step) {
  if (step.bone) step.frame.bone_clearance = step.bone->clearance;
  if (step.labrum) step.frame.labrum_clearance = step.labrum->clearance;
}

}  // namespace

struct LiveHip::Impl {
  const JointModel& model;
  LoadMode mode;
  Vec3 force;  // image axes; NaN with a prescribed pose
  JointOptions rough = live_options(), exact;
  HipSystem system;
  LedLimit bones, labrum;
  Equilibrium rough_equilibrium, exact_equilibrium;
  SocketElements elements;
  HipState state, trial;  // the trial keeps its storage from step to step
  Predictor predictor;

  Impl(const JointModel& hip, const LoadCase& load)
      : model(hip),
        mode(load.mode),
        force(mode == LoadMode::force ? Vec3(hip.X_IP.R * load.force_P.row(0).transpose())
                                      : Vec3::Constant(kNaN)),
        system(hip),
        bones(hip, hip.hip_bone),
        labrum(hip, hip.labrum),
        rough_equilibrium(system, mode, rough),
        exact_equilibrium(system, mode, exact),
        elements(socket_elements(hip)),
        state{system.reference(),
              {},
              system.make_contact(exact.contact_stiffness, exact.max_translation)},
        trial(state) {}

  Vec3 found() const { return state.x.segment<3>(3 * system.translation()); }
  RigidTransform placed(const BonePose& pose) const {
    return {pose.R, system.centre() + pose.shift + found() - pose.R * system.centre()};
  }
  BonePose pose_at(const motion::HipAngles& angles) const {
    const Mat3 R_PF = motion::rotation_from_angles(angles, model.side);
    return {model.X_IP.R * R_PF * model.X_IF.R.transpose(), Vec3::Zero()};
  }
  motion::HipAngles angles_of(const BonePose& pose) const {
    return motion::angles_from_rotation(model.X_IP.R.transpose() * pose.R * model.X_IF.R,
                                        model.side);
  }
  std::optional<NearPlace> nearest(LedLimit& limit, const RigidTransform& X_II) const;
  FrameResult solve(const BonePose& target, Exactness exactness, const Monitor& monitor);
  Step attempt(const BonePose& next, const Monitor& monitor);
};

FrameResult LiveHip::Impl::solve(const BonePose& target, Exactness exactness,
                                 const Monitor& monitor) {
  const auto start = std::chrono::steady_clock::now();
  Equilibrium& equilibrium = exactness == Exactness::result ? exact_equilibrium : rough_equilibrium;
  bool careful = exactness == Exactness::result;
  const auto attempt = [&] {
    trial = state;
    trial.contact.begin_slip(state.x);
    // a result does not depend on what was taken for too far to touch
    if (careful) trial.contact.forget_clearances();
    if (exactness == Exactness::by_hand) {
      // what presses by overlap presses without it from now on: multipliers follow the movement
      trial.contact.update_multipliers(trial.x, kInfinity);
    } else {
      trial.contact.clear_multipliers();  // a result does not depend on the way taken
    }
    predictor.carry(system, trial, target);
    return equilibrium.settle(trial, force, exactness, monitor);
  };
  Settling settling = attempt();
  if (!settling.converged && !careful) {
    // once more without guesses where the movement leads and what is too far to touch
    careful = true;
    predictor.forget();
    settling = attempt();
  }
  if (settling.converged) {
    // settling in place is no step
    if (exactness == Exactness::by_hand) predictor.note(state);
    std::swap(state, trial);
  }
  FrameResult frame;
  frame.status = settling.converged ? FrameStatus::converged : FrameStatus::failed;
  frame.reason = settling.reason;
  frame.residual = settling.residual;
  frame.iterations = settling.iterations;
  frame.X_II = placed(state.pose);
  frame.angles = angles_of(state.pose);
  if (settling.converged) {
    frame.translation = found();
    frame.balance.applied_force = force;
    if (exactness == Exactness::result)
      update_figures(frame, model, system, equilibrium, state, elements);
    else
      update_contact_figures(frame, model, system, equilibrium, state, elements.clock);
  }
  frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return frame;
}

LiveHip::LiveHip(const JointModel& model, const LoadCase& load) {
  check_model(model);
  require(load.mode != LoadMode::force || load.force_P.rows() == 1, "the load has ",
          load.force_P.rows(), " forces; a hip led by hand takes one for all poses");
  impl_ = std::make_unique<Impl>(model, load);
  if (load.mode != LoadMode::force) return;
  const std::string reason = impl_->exact_equilibrium.seat(impl_->state, impl_->force);
  if (!reason.empty()) fail(ErrorCode::no_convergence, reason);
  impl_->state.contact.forget_slip();
}

LiveHip::~LiveHip() = default;

motion::HipAngles LiveHip::angles() const { return impl_->angles_of(impl_->state.pose); }

LiveHip::Step LiveHip::step_towards(const motion::HipAngles& target, const Monitor& monitor) {
  const BonePose from = impl_->state.pose, to = impl_->pose_at(target);
  const double way = rotation_vector(to.R * from.R.transpose()).norm();
  const double share = std::min(1.0, impl_->rough.max_rotation_step / std::max(way, 1e-12));
  Step step = impl_->attempt(share < 1.0 ? between(from, to, share) : to, monitor);
  step.arrived = share == 1.0 || step.frame.status != FrameStatus::converged;
  // a step that finds no equilibrium is tried shorter
  for (double part = 0.5; step.frame.status == FrameStatus::failed && part > 0.2; part *= 0.5) {
    step = impl_->attempt(between(from, to, part * share), monitor);
    step.arrived = step.frame.status != FrameStatus::converged;
  }
  return step;
}

std::optional<LiveHip::NearPlace> LiveHip::Impl::nearest(LedLimit& limit,
                                                         const RigidTransform& X_II) const {
  const auto found = limit.nearest(X_II);
  if (!found) return std::nullopt;
  return NearPlace{found->distance, found->fixed_point, elements.clock.hour(found->fixed_point)};
}

/// A step to a pose, unless the bones would meet there.
LiveHip::Step LiveHip::Impl::attempt(const BonePose& next, const Monitor& monitor) {
  Step step;
  step.bone = nearest(bones, placed(next));
  step.labrum = nearest(labrum, placed(next));
  if (step.bone && step.bone->clearance < 0.0) {
    step.frame.status = FrameStatus::beyond_bony_limit;
    step.frame.reason = join_text("the bones would overlap by ", -step.bone->clearance, " mm");
    step.frame.X_II = placed(state.pose);
    step.frame.angles = angles_of(state.pose);
  } else {
    step.frame = solve(next, Exactness::by_hand, monitor);
  }
  note_clearances(step);
  return step;
}

LiveHip::Step LiveHip::settle(const Monitor& monitor) {
  Step step{impl_->solve(impl_->state.pose, Exactness::result, monitor), true, {}, {}};
  step.bone = impl_->nearest(impl_->bones, step.frame.X_II);
  step.labrum = impl_->nearest(impl_->labrum, step.frame.X_II);
  note_clearances(step);
  return step;
}

}  // namespace coxa::joint
