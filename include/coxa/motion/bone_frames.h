#pragma once

#include <coxa/mesh/surface_set.h>
#include <coxa/motion/hip_motion.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace coxa::motion {

/// Bony landmarks by the house's names, with or without the suffix _left or _right (asis_left,
/// psis_right, medial_epicondyle, …), and where they came from.
struct FrameLandmarks {
  std::map<std::string, Vec3> points;  ///< LPS mm
  std::string source = "landmarks";    ///< or "shape model completion"
  double sd = 2.0;                     ///< mm, of one coordinate of one landmark
};

struct BoneFrameOptions {
  /// Angle from the femoral neck's axis back to the axis of the condyles, about the femur's long
  /// axis, where no epicondyle is known; rad.
  /// The mean of 1507 femora against the epicondyles' axis (Davis et al. 2024).
  double mean_anteversion = 11.5 * kPi / 180.0;
  double anteversion_sd = 7.9 * kPi / 180.0;  ///< rad, of those about that mean
  /// Angle by which the upper shaft's line passes in front of the knee, seen from the hip; rad. The
  /// mean of two whole femora (docs/motion.md section 8).
  double mean_bow = 7.8 * kPi / 180.0;
  double femur_length = 420.0;  ///< mm, joint centre to knee centre, where the knee is not in view
  double positioning_sd =
      5.0 * kPi / 180.0;  ///< rad, of the pelvis in the scanner where only image axes are known
};

struct BoneFrames {
  BoneFrame pelvis, femur;                ///< origins at the joint centre
  std::map<std::string, Vec3> landmarks;  ///< those the frames stand on, with side, LPS mm
  std::vector<std::string> warnings;
};

/// ISB frames of pelvis and femur in the image, from the best that is known.
///
/// Pelvis: both ASIS and one PSIS by ISB; else one side's ASIS and PSIS with the image's left-right
/// axis; else the image's axes (x anterior, y superior, z right of a supine patient). Femur: both
/// epicondyles by ISB, given or found on the surface; else the long axis from the shaft, extended
/// to the knee, and the neck's axis turned back by the mean anteversion; else the image's axes.
/// `source` says which, `interval` how far the axes may be off.
/// @param surfaces      femur is used when the epicondyles are not known
/// @param joint_centre  LPS mm
/// @throws Error bad_input when landmarks contradict each other (on one line, or right of left)
/// Source: Wu et al. 2002; docs/motion.md section 3.
BoneFrames make_bone_frames(const SurfaceSet& surfaces, const FrameLandmarks& landmarks,
                            const Vec3& joint_centre, Side side,
                            const BoneFrameOptions& options = {});

/// LPS mm.
struct Epicondyles {
  Vec3 medial, lateral;
};
/// The epicondyles of a femur whose knee is in view: the outermost places of its lower 60 mm across
/// the line of the posterior condyles. nullopt where the surface ends above the knee.
std::optional<Epicondyles> find_epicondyles(const TriMesh& femur, const Vec3& joint_centre,
                                            Side side);

/// ISB axes from landmarks; columns x anterior, y superior, z right.
Mat3 pelvis_axes(const Vec3& asis_right, const Vec3& asis_left, const Vec3& mid_psis);
Mat3 femur_axes(const Vec3& joint_centre, const Vec3& medial_epicondyle,
                const Vec3& lateral_epicondyle, Side side);
/// The image's axes as a supine patient's: x = -LPS y, y = LPS z, z = -LPS x.
Mat3 supine_axes();

/// Axes of the proximal femur that are in view.
struct ProximalFemurAxes {
  Vec3 shaft_point, shaft_direction;  ///< mm; unit, pointing proximal
  Vec3 neck_direction;                ///< unit, from the head's centre to the neck, lateral
  double shaft_length = 0.0;          ///< mm of shaft below the lesser trochanter that was used
};
/// From cross-sections of the shaft and of the neck. @throws Error bad_input if less than 20 mm of
/// shaft is in view
ProximalFemurAxes proximal_femur_axes(const TriMesh& femur, const Vec3& joint_centre,
                                      double head_radius);

}  // namespace coxa::motion
