#include <coxa/joint/simulate.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/measures.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bone_limit.h"
#include "frame_figures.h"
#include "march.h"

namespace coxa::joint {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check(const motion::HipMotion& motion, const LoadCase& load, const JointOptions& options) {
  const auto n = static_cast<std::size_t>(motion.n_frames());
  require(n > 0, "the movement has no frame");
  require(motion.X_PF.size() == n && motion.angles.size() == n, "the movement has ", n, " times, ",
          motion.angles.size(), " angles and ", motion.X_PF.size(), " poses; they must be as many");
  if (load.mode == LoadMode::force) {
    const Index rows = static_cast<Index>(load.force_P.rows());
    require(rows == 1 || rows == motion.n_frames(), "the load has ", rows,
            " forces; it needs one, or one a frame (", motion.n_frames(), ")");
    require(load.force_P.allFinite() && load.force_P.rowwise().norm().minCoeff() > 0.0,
            "every joint force must be finite and not zero");
  }
  const auto positive = [](double value, const char* name) {
    require(value > 0.0, name, " must be positive, got ", value);
  };
  positive(options.contact_stiffness, "contact_stiffness");
  positive(options.penetration_tolerance, "penetration_tolerance");
  positive(options.residual_tolerance, "residual_tolerance");
  positive(options.max_rotation_step, "max_rotation_step");
  positive(options.max_translation_step, "max_translation_step");
  positive(options.max_newton_iterations, "max_newton_iterations");
  positive(options.max_contact_updates, "max_contact_updates");
  positive(options.max_translation, "max_translation");
  require(options.max_cutbacks >= 0, "max_cutbacks must not be negative, got ",
          options.max_cutbacks);
  if (options.centre_shift) positive(*options.centre_shift, "centre_shift");
}

/// A frame whose equilibrium turns an element inside out is none of the tissue.
FrameResult without_result(const FrameResult& frame) {
  FrameResult failed;
  failed.frame = frame.frame;
  failed.status = FrameStatus::failed;
  failed.reason =
      join_text("an element of the ", frame.crush.body, " near ", frame.crush.place.transpose(),
                " is turned inside out: volume ratio ", frame.crush.least_volume_ratio);
  failed.angles = frame.angles;
  failed.X_II = frame.X_II;
  failed.bone_clearance = frame.bone_clearance;
  failed.labrum_clearance = frame.labrum_clearance;
  failed.residual = frame.residual;
  failed.iterations = frame.iterations;
  return failed;
}

/// One simulation: what lasts from frame to frame.
class Simulation {
 public:
  Simulation(const JointModel& model, const motion::HipMotion& motion, const LoadCase& load,
             const JointOptions& options, const Monitor& monitor)
      : model_(model),
        motion_(motion),
        load_(load),
        options_(options),
        monitor_(monitor),
        system_(model),
        march_(system_, load.mode, options),
        limit_(model),
        labrum_(model, model.labrum),
        elements_(socket_elements(model)),
        state_{system_.reference(),
               {},
               system_.make_contact(options.contact_stiffness, options.max_translation)} {}

  JointResult run();

 private:
  Vec3 force(Index frame) const {
    if (load_.mode == LoadMode::prescribed_pose) return Vec3::Constant(kNaN);
    return model_.X_IP.R *
           load_.force_P.row(std::min<Index>(frame, load_.force_P.rows() - 1)).transpose();
  }
  BonePose pose(Index frame) const;
  RigidTransform placed(const BonePose& pose) const;
  Vec3 found() const { return state_.x.segment<3>(3 * system_.translation()); }
  void run_frame(FrameResult& frame);
  BonyLimit first_touch(const BoneLimit& limit, Index frame, const BonePose& target) const;
  void find_sensitivity();

  const JointModel& model_;
  const motion::HipMotion& motion_;
  const LoadCase& load_;
  const JointOptions& options_;
  const Monitor& monitor_;
  HipSystem system_;
  March march_;
  BoneLimit limit_, labrum_;
  SocketElements elements_;
  HipState state_;
  BonePose previous_;     // of the frame before, solved or not
  std::string unseated_;  // why the head could not be seated at all
  JointResult result_;
};

BonePose Simulation::pose(Index frame) const {
  const RigidTransform X_II =
      model_.X_IP * motion_.X_PF[static_cast<std::size_t>(frame)] * model_.X_IF.inverse();
  BonePose pose{X_II.R, Vec3::Zero()};
  if (load_.mode == LoadMode::prescribed_pose)
    pose.shift = X_II * system_.centre() - system_.centre();
  return pose;
}

/// Where the femur is at a pose, with the translation found so far.
RigidTransform Simulation::placed(const BonePose& pose) const {
  return {pose.R, system_.centre() + pose.shift + found() - pose.R * system_.centre()};
}

/// Where on the way from the frame before the femur first meets what is watched.
BonyLimit Simulation::first_touch(const BoneLimit& limit, Index frame,
                                  const BonePose& target) const {
  const auto pose_at = [&](double s) { return placed(between(previous_, target, s)); };
  const collide::FirstContact touch = limit.first_touch(pose_at);
  const BonePose at = between(previous_, target, touch.parameter);
  const Mat3 R_PF = model_.X_IP.R.transpose() * at.R * model_.X_IF.R;
  return {.frame = frame,
          .angles = motion::angles_from_rotation(R_PF, model_.side),
          .place = touch.clearance.fixed_point,
          .hour = result_.clock.hour(touch.clearance.fixed_point)};
}

void Simulation::run_frame(FrameResult& frame) {
  const auto start = std::chrono::steady_clock::now();
  frame.angles = motion_.angles[static_cast<std::size_t>(frame.frame)];
  const BonePose target = pose(frame.frame);
  frame.X_II = placed(target);
  frame.bone_clearance = limit_.clearance(frame.X_II);
  frame.labrum_clearance = labrum_.clearance(frame.X_II);
  if (frame.labrum_clearance < 0.0 && !result_.labrum_contact)
    result_.labrum_contact = first_touch(labrum_, frame.frame, target);
  if (frame.bone_clearance < 0.0) {
    frame.status = FrameStatus::beyond_bony_limit;
    frame.reason = join_text("the bones would overlap by ", -frame.bone_clearance, " mm");
    if (!result_.bony_limit) result_.bony_limit = first_touch(limit_, frame.frame, target);
  } else if (!unseated_.empty()) {
    frame.reason = unseated_;
  } else {
    Settling settling = march_.advance(state_, target, force(frame.frame), monitor_);
    // with friction, equilibrium is the way's
    const bool any_way = load_.mode == LoadMode::force && model_.friction == 0.0;
    if (!settling.converged && any_way) {
      const int spent = settling.iterations;
      settling = march_.start_anew(state_, target, force(frame.frame), monitor_);
      settling.iterations += spent;
    }
    frame.status = settling.converged ? FrameStatus::converged : FrameStatus::failed;
    frame.reason = settling.reason;
    frame.residual = settling.residual;
    frame.iterations = settling.iterations;
    if (settling.converged) {
      frame.X_II = placed(target);
      frame.translation = target.shift + found();
      frame.balance.applied_force = force(frame.frame);
      frame.balance.work = march_.work();
      update_figures(frame, model_, system_, march_.equilibrium(), state_, elements_);
      if (frame.crush.least_volume_ratio <= 0.0) frame = without_result(frame);
    }
  }
  previous_ = target;
  frame.seconds = seconds_since(start);
}

void Simulation::find_sensitivity() {
  const FrameResult* last = nullptr;
  for (const FrameResult& frame : result_.frames) {
    if (frame.status == FrameStatus::converged) last = &frame;
  }
  if (last == nullptr) return;
  CentreSensitivity sensitivity;
  sensitivity.frame = last->frame;
  sensitivity.shift = *options_.centre_shift;
  sensitivity.at_rest = last->contact.peak_pressure_p99;
  // the pose held where the frame found it, then shifted along the pelvis axes
  March held(system_, LoadMode::prescribed_pose, options_);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      HipState state = state_;
      BonePose target = state.pose;
      target.shift += (side == 0 ? -1.0 : 1.0) * sensitivity.shift * model_.X_IP.R.col(axis);
      const Settling settling = held.advance(state, target, Vec3::Constant(kNaN), monitor_);
      sensitivity.peak(axis, side) = kNaN;
      if (!settling.converged) continue;
      auto samples = state.contact.cartilages().samples(state.x);
      sensitivity.peak(axis, side) =
          pressure_percentile(samples_in_contact(system_, state, std::move(samples)), 0.99);
    }
  }
  result_.sensitivity = sensitivity;
}

JointResult Simulation::run() {
  const auto start = std::chrono::steady_clock::now();
  const TriMesh articular{model_.acetabular_cartilage.points,
                          facets_with(model_.acetabular_cartilage, FacetTag::articular_side)};
  result_.articular_area = area(articular);
  result_.clock = elements_.clock;
  result_.load_description = load_.description;
  result_.bare_bone = model_.bare_bone;
  result_.has_friction = model_.friction > 0.0;
  result_.has_labrum = !model_.labrum.empty();
  result_.has_labrum_body = model_.labrum_body.n_tets() > 0;
  for (const Ligament& ligament : model_.ligaments) result_.ligaments.push_back(ligament.name);
  if (load_.mode == LoadMode::force) unseated_ = march_.equilibrium().seat(state_, force(0));
  state_.contact.forget_slip();

  const Index n = motion_.n_frames();
  for (Index k = 0; k < n; ++k) {
    FrameResult frame;
    frame.frame = k;
    run_frame(frame);
    result_.frames.push_back(std::move(frame));
    monitor_.progress("simulate", static_cast<double>(k + 1) / n);
  }
  if (options_.centre_shift) find_sensitivity();
  result_.seconds = seconds_since(start);
  return std::move(result_);
}

}  // namespace

const char* name_of(FrameStatus status) {
  switch (status) {
    case FrameStatus::converged:
      return "converged";
    case FrameStatus::failed:
      return "failed";
    case FrameStatus::beyond_bony_limit:
      return "beyond_bony_limit";
  }
  return "";
}

Index JointResult::n_converged() const {
  return static_cast<Index>(std::count_if(frames.begin(), frames.end(), [](const FrameResult& f) {
    return f.status == FrameStatus::converged;
  }));
}

JointResult simulate(const JointModel& model, const motion::HipMotion& motion, const LoadCase& load,
                     const JointOptions& options, const Monitor& monitor) {
  check_model(model);
  check(motion, load, options);
  return Simulation(model, motion, load, options, monitor).run();
}

}  // namespace coxa::joint
