#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/solve_report.h>
#include <coxa/motion/hip_model.h>
#include <coxa/motion/hip_motion.h>
#include <coxa/motion/marker_data.h>

#include <string>
#include <string_view>
#include <vector>

namespace coxa::motion {

/// How the femur's pose is found from the thigh markers.
enum class PoseMethod {
  paper,  ///< per frame: rotation and one free artefact translation, least squares; head at the
          ///< centre
  rigid,  ///< per frame: plain least-squares rigid fit of the cluster; the head goes where it goes
  point_cluster,  ///< per frame: principal axes of the cluster, weights that keep its moments
                  ///< constant
  ball_joint,     ///< per frame: rotation about the joint centre, equal weights
  ball_joint_ml,  ///< the same, each marker's variance estimated by maximum likelihood over the
                  ///< trial
  coxa  ///< ball joint whose markers share part of their artefact, weights chosen by the trial
};
inline constexpr PoseMethod kAllPoseMethods[] = {PoseMethod::paper,         PoseMethod::rigid,
                                                 PoseMethod::point_cluster, PoseMethod::ball_joint,
                                                 PoseMethod::ball_joint_ml, PoseMethod::coxa};
std::string_view name(PoseMethod method);
/// @throws Error usage naming the methods there are
PoseMethod pose_method(std::string_view name);

struct TrackOptions {
  PoseMethod method = PoseMethod::coxa;
  double measurement_sd = 0.5;  ///< mm, > 0, of one marker coordinate as the cameras see it
  double joint_translation_sd =
      0.5;  ///< mm, >= 0, of the head in the socket per axis; into the intervals
  /// Share of a rotation away from the calibration pose that all thigh markers may miss together,
  /// as a standard deviation; no estimate from thigh markers can see it, so it goes into the
  /// intervals (long axis of the femur).
  double common_rotation_share = 0.10;  ///< >= 0
};

/// Everything a tracking gives beside the motion.
struct TrackResult {
  HipMotion motion;
  std::vector<std::string> thigh_labels;  ///< K markers used
  MatX residuals;  ///< frames×K, mm, distance of marker from model; NaN where not seen
  VecX marker_sd;  ///< K, mm, estimated spread of each marker's artefact per axis
  std::vector<RigidTransform> X_LP,
      X_LF;  ///< poses of the model's pelvis and femur frames in the laboratory
  SolveReport report;
};

/// The femur's movement in the pelvis from skin markers.
///
/// Frames where fewer than three pelvis markers or two (rigid, paper, point_cluster: three) thigh
/// markers are seen are bridged from their neighbours, named in the warnings, and their interval is
/// widened.
/// @throws Error bad_input when model and recording share too few markers; the text lists the
/// labels
/// @note   bit-identical for any number of threads
/// Source: docs/motion.md section 4.
TrackResult track_in_detail(const MarkerData& markers, const HipModel& model,
                            const TrackOptions& options = {}, const Monitor& monitor = {});
HipMotion track(const MarkerData& markers, const HipModel& model, const TrackOptions& options = {},
                const Monitor& monitor = {});
/// One result per method, in the order of kAllPoseMethods.
std::vector<TrackResult> track_comparison(const MarkerData& markers, const HipModel& model,
                                          const TrackOptions& options = {},
                                          const Monitor& monitor = {});

}  // namespace coxa::motion
