#pragma once

#include <coxa/core/types.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace coxa::motion {

/// What an MRI with markers, or a calibration pose, tells about one hip: the joint centre in both
/// bones' ISB axes, and where each marker sits on its bone.
///
/// Both frames have ISB axes (x anterior, y superior, z right); their origins are free, the joint
/// centre is given in each.
struct HipModel {
  Side side = Side::right;
  Vec3 joint_centre_pelvis = Vec3::Zero();     ///< mm, pelvis frame
  Vec3 joint_centre_femur = Vec3::Zero();      ///< mm, femur frame
  std::map<std::string, Vec3> pelvis_markers;  ///< label -> mm, pelvis frame; at least three
  std::map<std::string, Vec3> thigh_markers;   ///< label -> mm, femur frame; at least three
  std::optional<Index>
      calibration_frame;          ///< frame of the recording in which the positions were taken
  double marker_sd = 0.0;         ///< mm, of the marker positions on the bones, per axis
  double pelvis_centre_sd = 0.0;  ///< mm, of joint_centre_pelvis, per axis
  double femur_centre_sd = 0.0;   ///< mm, of joint_centre_femur, per axis
  std::string source;             ///< where it came from, in words
};

/// @throws Error bad_input naming what is missing, not finite, or lies on one line
void check_model(const HipModel& model);

}  // namespace coxa::motion
