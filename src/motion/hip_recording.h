#pragma once

#include <coxa/motion/hip_model.h>
#include <coxa/motion/marker_data.h>

#include <string>
#include <vector>

#include "thigh_observations.h"

namespace coxa::motion {

/// The recording as one hip sees it: pelvis poses, and the thigh markers in the pelvis.
struct HipRecording {
  std::vector<RigidTransform> X_LP;  ///< per frame, model's pelvis frame in the laboratory
  std::vector<bool> pelvis_seen;     ///< per frame; false: pose taken from neighbouring frames
  double pelvis_residual_sd =
      0.0;                        ///< mm per axis, spread of the pelvis markers about the rigid fit
  Mat3 pelvis_information;        ///< sum of J^T J over the pelvis markers about their mean, mm²
  double pelvis_centre_sd = 0.0;  ///< mm per axis, how far the spread moves the joint centre
  std::vector<std::string> thigh_labels;
  ThighObservations thigh;
};

/// Matches labels, fits the pelvis per frame, and expresses the thigh markers about the joint
/// centre.
HipRecording make_recording(const MarkerData& markers, const HipModel& model,
                            std::vector<std::string>& warnings);

/// Fills frames whose flag is false from their neighbours: rotation along the shortest arc,
/// translation straight.
void update_missing_poses(std::vector<RigidTransform>& poses, const std::vector<bool>& known);

/// "3 frames (12-14)" style text of the frames where the flag is false, counted from 1.
std::string list_of_missing(const std::vector<bool>& known);

}  // namespace coxa::motion
