#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/types.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/motion/head_shape.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::motion {

/// One estimate of the hip joint centre.
struct JointCentre {
  std::string definition;      ///< "femoral_head", "femoral_cartilage", "acetabulum", "congruency",
                               ///< "harrington", …
  Vec3 centre = Vec3::Zero();  ///< mm, in the frame of what it was computed from
  double radius = 0.0;         ///< mm, of the fitted sphere; 0 where none was fitted
  double rms = 0.0;            ///< mm, of the residuals over the region used
  double covered_share = 0.0;  ///< of the whole sphere's directions that the region covers, 0..1
  double interval = 0.0;       ///< mm, half-width of the 95 % interval of each coordinate
  std::string region;          ///< what was fitted, in words
};

/// What is known about a femoral head beyond what is in view.
struct HeadPrior {
  HeadShape shape;
  Side side = Side::right;  ///< of the hip
};

struct JointCentreOptions {
  std::optional<Vec3> start =
      {};  ///< mm, near the head's centre (a landmark); found from the femur when absent
  double smallest_radius = 15.0;  ///< mm, of a head that is looked for without a start
  double largest_radius = 34.0;   ///< mm
  double neck_cone =
      65.0 * kPi / 180.0;      ///< rad, directions nearer than this to the neck's are left out
  double outlier_scale = 4.7;  ///< Tukey cut-off of the sphere fits, in robust standard deviations
  Index congruency_samples =
      300;  ///< points at which the space between the surfaces is compared; 0: skip
  /// Completes a head of the femur that is seen in part; the surfaces must be in LPS then. A head
  /// seen whole is not touched.
  std::optional<HeadPrior> head_prior = {};
};

/// All centres that these surfaces allow, and the one to use.
struct JointCentreResult {
  JointCentre chosen;  ///< the femoral head's sphere; the cartilage's where the femur is missing
  std::vector<JointCentre> all;  ///< side by side, `chosen` among them
  double largest_spread = 0.0;   ///< mm, largest distance between two of them
  std::vector<std::string> warnings;
};

/// The hip joint centre from bone and cartilage surfaces in one frame, mm.
///
/// Sphere of the femoral head (bone without the neck's side and without outliers such as the
/// fovea), of the articular sides of both cartilages, of the acetabulum's bone side, and the
/// congruency centre: the one about which the head turns with the most constant space to the
/// socket.
/// @param surfaces  some of femur, femoral_cartilage, acetabular_cartilage (house names)
/// @throws Error bad_input when none of them is there or no head-like sphere is found
/// Source: docs/motion.md section 2.
JointCentreResult find_joint_centre(const SurfaceSet& surfaces,
                                    const JointCentreOptions& options = {},
                                    const Monitor& monitor = {});

/// Centre that keeps the distance between two articular surfaces most constant while the head turns
/// about it.
///
/// Minimises the variance over sample points and poses of the distance from the socket's articular
/// surface to the head's, for rotations up to 30 degrees about three axes. Source: the paper's
/// reference [69]; docs/motion.md.
JointCentre congruency_centre(const TriMesh& head, const TriMesh& socket, const Vec3& start,
                              Index n_samples);

}  // namespace coxa::motion
