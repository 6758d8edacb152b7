#include <coxa/motion/track.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include <algorithm>
#include <cmath>

#include "artefact_model.h"
#include "hip_recording.h"
#include "pose_intervals.h"

namespace coxa::motion {
namespace {

void check_options(const TrackOptions& options) {
  require(options.measurement_sd > 0, "measurement_sd must be above 0 mm, got ",
          options.measurement_sd);
  require(options.joint_translation_sd >= 0, "joint_translation_sd must not be negative, got ",
          options.joint_translation_sd);
  require(options.common_rotation_share >= 0, "common_rotation_share must not be negative, got ",
          options.common_rotation_share);
}

// errors of the model and the cameras that the markers carry beside artefact
struct ErrorBudget {
  KnownErrors known;
  std::optional<Mat3> registration;  // rad², where the calibration frame put the positions right
};

// mean square of what is left of a pelvis centre's error after the calibration frame took it up
double turned_centre_variance(const ThighObservations& thigh, Index calibration_frame, double sd) {
  const std::vector<Mat3> R = estimate_rigid(thigh).R_PF;
  double sum = 0.0;
  for (const Mat3& R_k : R)
    sum += (R_k - R[static_cast<std::size_t>(calibration_frame)]).squaredNorm() / 3.0;
  return sd * sd * sum / static_cast<double>(R.size());
}

// `coxa` puts the marker positions right by the frame they were measured in; the others take them
// as they are
ErrorBudget update_registration(HipRecording& recording, const HipModel& model,
                                const TrackOptions& options) {
  ThighObservations& thigh = recording.thigh;
  const double moving = std::hypot(options.joint_translation_sd, recording.pelvis_centre_sd);
  const double centres = std::pow(model.pelvis_centre_sd, 2) + std::pow(model.femur_centre_sd, 2);
  const KnownErrors registration{.marker = std::hypot(model.marker_sd, options.measurement_sd),
                                 .shift = std::sqrt(centres)};
  ErrorBudget budget{
      {.marker = registration.marker, .shift = std::hypot(moving, registration.shift)}, {}};
  if (options.method != PoseMethod::coxa || !model.calibration_frame || model.marker_sd == 0)
    return budget;
  const Index frame = *model.calibration_frame;
  const auto registered = registered_positions(thigh, frame, registration);
  if (!registered) return budget;
  thigh.x = registered->x;
  const double turned = turned_centre_variance(thigh, frame, model.pelvis_centre_sd);
  return {{.marker = options.measurement_sd, .shift = std::hypot(moving, std::sqrt(turned))},
          registered->covariance};
}

PoseEstimate estimate_poses(const ThighObservations& thigh, const ArtefactModel& artefact,
                            const KnownErrors& known, const TrackOptions& options) {
  const Index K = thigh.n_markers();
  switch (options.method) {
    case PoseMethod::paper:
      return estimate_paper(thigh);
    case PoseMethod::rigid:
      return estimate_rigid(thigh);
    case PoseMethod::point_cluster:
      return estimate_point_cluster(thigh);
    case PoseMethod::ball_joint:
      return estimate_ball_joint(thigh, MatX::Identity(K, K));
    case PoseMethod::ball_joint_ml:
      return estimate_ball_joint_ml(thigh, options.measurement_sd);
    case PoseMethod::coxa:
      return estimate_coxa(thigh, artefact, known);
  }
  COXA_ASSERT(false);
  return {};
}

void update_unsolved_frames(PoseEstimate& estimate, std::vector<std::string>& warnings) {
  require(std::find(estimate.valid.begin(), estimate.valid.end(), true) != estimate.valid.end(),
          "no frame shows enough thigh markers at once");
  if (std::find(estimate.valid.begin(), estimate.valid.end(), false) == estimate.valid.end())
    return;
  warnings.push_back("femur bridged in " + list_of_missing(estimate.valid));
  std::vector<RigidTransform> poses(estimate.R_PF.size());
  for (std::size_t f = 0; f < poses.size(); ++f) poses[f] = {estimate.R_PF[f], estimate.head[f]};
  update_missing_poses(poses, estimate.valid);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    estimate.R_PF[f] = poses[f].R;
    estimate.head[f] = poses[f].p;
  }
}

void set_residuals(const HipRecording& recording, const PoseEstimate& estimate,
                   TrackResult& result) {
  const Index n = recording.thigh.n_frames(), K = recording.thigh.n_markers();
  result.residuals.resize(n, K);
  for (Index frame = 0; frame < n; ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    result.residuals.row(frame) =
        residuals_of(recording.thigh, frame, estimate.R_PF[f], estimate.head[f])
            .rowwise()
            .norm()
            .transpose();
  }
  result.marker_sd.resize(K);
  for (Index m = 0; m < K; ++m) {
    double sum = 0.0, count = 0.0;
    for (Index frame = 0; frame < n; ++frame) {
      if (recording.thigh.seen(frame, m) == 0) continue;
      sum += std::pow(result.residuals(frame, m), 2) / 3.0;
      count += 1.0;
    }
    result.marker_sd[m] = std::sqrt(sum / std::max(1.0, count));
  }
}

}  // namespace

std::string_view name(PoseMethod method) {
  switch (method) {
    case PoseMethod::paper:
      return "paper";
    case PoseMethod::rigid:
      return "rigid";
    case PoseMethod::point_cluster:
      return "point_cluster";
    case PoseMethod::ball_joint:
      return "ball_joint";
    case PoseMethod::ball_joint_ml:
      return "ball_joint_ml";
    case PoseMethod::coxa:
      return "coxa";
  }
  return "unknown";
}

PoseMethod pose_method(std::string_view text) {
  std::string there;
  for (const PoseMethod method : kAllPoseMethods) {
    if (name(method) == text) return method;
    there += (there.empty() ? "" : ", ") + std::string(name(method));
  }
  fail(ErrorCode::usage, "no pose method '", text, "'; there are: ", there);
}

TrackResult track_in_detail(const MarkerData& markers, const HipModel& model,
                            const TrackOptions& options, const Monitor& monitor) {
  check_options(options);
  monitor.check_cancelled();
  TrackResult result;
  HipMotion& motion = result.motion;
  motion.warnings = markers.warnings;
  HipRecording recording = make_recording(markers, model, motion.warnings);
  monitor.progress("track", 0.2);

  const ErrorBudget errors = update_registration(recording, model, options);
  const ArtefactModel artefact = estimate_artefact(recording.thigh, errors.known);
  PoseEstimate estimate = estimate_poses(recording.thigh, artefact, errors.known, options);
  update_unsolved_frames(estimate, motion.warnings);
  result.report = {.converged = estimate.converged,
                   .iterations = estimate.iterations,
                   .residual = 0.0,
                   .reason = estimate.converged ? "" : "the marker variances were still changing"};
  monitor.progress("track", 0.8);
  monitor.check_cancelled();

  motion.method = name(options.method);
  motion.interval =
      pose_intervals(recording, model, estimate, artefact, errors.registration, options);
  motion.head_lab.resize(markers.n_frames(), 3);
  for (Index frame = 0; frame < markers.n_frames(); ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    const RigidTransform X_PF{estimate.R_PF[f], estimate.head[f]};
    const RigidTransform X_P{Mat3::Identity(), model.joint_centre_pelvis},
        X_F{Mat3::Identity(), model.joint_centre_femur};
    motion.time.push_back(markers.time(frame));
    motion.X_PF.push_back(X_PF);
    motion.angles.push_back(angles_from_rotation(X_PF.R, model.side));
    motion.head_lab.row(frame) = recording.X_LP[f] * (model.joint_centre_pelvis + X_PF.p);
    result.X_LP.push_back(recording.X_LP[f]);
    result.X_LF.push_back(recording.X_LP[f] * X_P * X_PF * X_F.inverse());
  }
  result.thigh_labels = recording.thigh_labels;
  set_residuals(recording, estimate, result);
  monitor.progress("track", 1.0);
  return result;
}

HipMotion track(const MarkerData& markers, const HipModel& model, const TrackOptions& options,
                const Monitor& monitor) {
  return track_in_detail(markers, model, options, monitor).motion;
}

std::vector<TrackResult> track_comparison(const MarkerData& markers, const HipModel& model,
                                          const TrackOptions& options, const Monitor& monitor) {
  std::vector<TrackResult> results;
  for (const PoseMethod method : kAllPoseMethods) {
    TrackOptions chosen = options;
    chosen.method = method;
    results.push_back(track_in_detail(markers, model, chosen, monitor));
  }
  return results;
}

}  // namespace coxa::motion
