#pragma once

#include <coxa/motion/bone_frames.h>
#include <coxa/motion/hip_model.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/motion/marker_map.h>

#include <optional>

namespace coxa::motion {

/// Where the joint centre of a calibration comes from.
enum class CentreSource { surfaces, harrington, bell, score, functional_sphere };

/// What surfaces from an MRI without markers tell a calibration: the joint centre, and the pelvis
/// landmarks by which the image is laid on the markers.
struct ImagedPelvis {
  std::map<std::string, Vec3> landmarks =
      {};                    ///< asis_left, asis_right, psis_left, psis_right: image, LPS mm
  double landmark_sd = 2.0;  ///< mm, of one coordinate of one landmark
  Vec3 joint_centre = Vec3::Zero();  ///< LPS mm
  double joint_centre_sd = 0.5;      ///< mm, per axis, in the image
};

struct CalibrationOptions {
  Side side = Side::right;
  MarkerMap map = {};                   ///< empty: default_marker_map(side)
  Index first_frame = 0;                ///< frames that calibrate: [first_frame, end_frame)
  std::optional<Index> end_frame = {};  ///< to the end of the recording when absent
  /// nullopt: the surfaces' where there is an image, else Harrington's
  std::optional<CentreSource> centre = {};
  std::optional<ImagedPelvis> image = {};
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

/// The joint centre of an image in the pelvis ISB frame of the markers, definition "surfaces".
///
/// Its interval: the centre's own, and what the landmarks' errors on bone and skin (the larger of
/// those stated and of those that the fit leaves) do to it through the rigid fit.
/// @param in_pelvis as for `register_image`; with `mid_psis` in place of the PSIS where the markers
///                  have a sacrum only
/// @throws Error bad_input when fewer than three landmarks are common to both
JointCentre registered_centre(const ImagedPelvis& image,
                              const std::map<std::string, Vec3>& in_pelvis, double marker_sd);

/// Positions of the pelvis landmarks of a model in its pelvis frame, by house name, for
/// `register_image`.
std::map<std::string, Vec3> pelvis_landmarks(const HipModel& model, const MarkerMap& map);

}  // namespace coxa::motion
