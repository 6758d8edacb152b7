#pragma once

#include <coxa/geom/clock_face.h>
#include <coxa/mesh/surface_set.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/motion/joint_centre.h>

#include <array>
#include <string>
#include <vector>

namespace coxa::measure {

/// Shape of one hip in numbers, rad and mm; NaN where the surfaces do not show it.
struct Morphometry {
  double head_radius = kNaN;
  double head_rms = kNaN;  ///< of the head's surface from its sphere: roundness

  double neck_shaft_angle = kNaN;
  double femoral_version = kNaN;       ///< neck axis against the epicondyles, across the long axis
  std::array<double, 12> alpha_angle;  ///< about the neck by hour: 0 superior, 3 anterior
  double largest_alpha_angle = kNaN;
  Index largest_alpha_hour = 0;

  double lateral_centre_edge_angle = kNaN;
  double acetabular_inclination = kNaN, acetabular_version = kNaN;  ///< anatomical definition
  ClockFace socket;  ///< of the acetabulum, in the image frame: 12 superior, 3 anterior

  std::vector<std::string> notes;  ///< why a figure is missing
};

/// Measures femur and acetabulum from their surfaces.
///
/// The head is the joint centre's sphere; its contour leaves it where it is farther outside than
/// 0.75 mm and twice the rms of the fit. The neck's and the shaft's axes come from cross-sections.
/// The acetabulum is the surface of its cartilage: its lateral edge is where the weight-bearing
/// zone ends, its opening the plane through the outer rim of the horseshoe. Femoral version needs
/// the epicondyles: a femur frame from anything else gives NaN.
/// @param surfaces  of femur and acetabular_cartilage those that are to be measured, LPS mm
/// @param frames    of pelvis and femur in the image, origins at the joint centre
/// @param head      centre (image frame), radius and rms of the femoral head
/// Source: docs/measure.md section 4.
Morphometry hip_morphometry(const SurfaceSet& surfaces, const motion::BoneFrames& frames,
                            const motion::JointCentre& head, Side side);

/// Unit vector out of a socket: normal of the plane through the points of its outer rim.
///
/// @param socket  open or closed surface of the socket or of its cartilage, mm
/// @param centre  of the head, mm
/// @throws Error bad_input if the surface is no socket about the centre
Vec3 socket_axis(const TriMesh& socket, const Vec3& centre);

}  // namespace coxa::measure
