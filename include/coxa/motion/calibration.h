#pragma once

#include <coxa/motion/bone_frames.h>
#include <coxa/motion/hip_model.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/motion/marker_map.h>

#include <optional>

namespace coxa::motion {

/// Where the joint centre of a calibration comes from.
enum class CentreSource { harrington, bell, score, functional_sphere };

struct CalibrationOptions {
  Side side = Side::right;
  MarkerMap map = {};                   ///< empty: default_marker_map(side)
  Index first_frame = 0;                ///< frames that calibrate: [first_frame, end_frame)
  std::optional<Index> end_frame = {};  ///< to the end of the recording when absent
  CentreSource centre = CentreSource::harrington;
  std::optional<Vec3> joint_centre_pelvis =
      {};  ///< mm, pelvis ISB axes from mid-ASIS: wins over `centre` (an MRI's)
  double joint_centre_sd = 2.0;  ///< mm, of joint_centre_pelvis
  double knee_half_width =
      55.0;                ///< mm, lateral marker to knee centre where there is no medial one
  double marker_sd = 3.0;  ///< mm, of marker positions and landmarks palpated through skin
};

struct Calibration {
  HipModel model;
  std::vector<JointCentre> centres;  ///< all estimates, pelvis ISB axes from mid-ASIS
  std::vector<std::string> warnings;
};

/// A hip's model from anatomical markers: pelvis frame by ISB from ASIS and PSIS (or the sacrum),
/// joint centre by the source asked for, femur frame from joint centre and knee, marker positions
/// averaged over the neutral frames.
///
/// Functional centres use all frames of `markers`.
/// @throws Error bad_input naming the roles that no label fills
Calibration calibrate(const MarkerData& markers, const CalibrationOptions& options);

/// Pose of the image in the pelvis ISB frame (origin mid-ASIS) from landmarks found in both.
struct Registration {
  RigidTransform X_PI;  ///< p_P = X_PI p_I
  double rms = 0.0;     ///< mm
  Index n_landmarks = 0;
};
/// @param in_image  landmarks in the image (house names with side), LPS mm
/// @param in_pelvis the same landmarks in the pelvis frame (asis_left, asis_right, psis_left,
/// psis_right)
/// @throws Error bad_input when fewer than three are common to both
Registration register_image(const std::map<std::string, Vec3>& in_image,
                            const std::map<std::string, Vec3>& in_pelvis);

/// Positions of the pelvis landmarks of a model in its pelvis frame, by house name, for
/// `register_image`.
std::map<std::string, Vec3> pelvis_landmarks(const HipModel& model, const MarkerMap& map);

}  // namespace coxa::motion
