#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::measure {

/// Orientation of a socket, anatomical definition (Murray 1993), rad.
struct AcetabularOrientation {
  double inclination = 0.0;  ///< between the axis and the body's downward direction
  double version =
      0.0;  ///< of the axis in the transverse plane, from lateral; positive opens forward
};

/// @param axis_P unit vector out of the socket in the pelvis frame (x anterior, y superior, z
/// right)
AcetabularOrientation acetabular_orientation(const Vec3& axis_P, Side side);

/// Lateral centre-edge angle (Wiberg), rad: in the coronal plane of the pelvis, between upwards and
/// the line from the head's centre to the edge; positive where the edge lies lateral of the centre.
/// @param centre_P, edge_P mm, pelvis frame
double lateral_centre_edge_angle(const Vec3& centre_P, const Vec3& edge_P, Side side);

/// The edge of a socket for that angle: the most lateral point of its surface above the centre
/// within `half_slab` mm of the coronal plane through the centre.
/// @throws Error bad_input if no vertex lies there
Vec3 find_lateral_edge(const TriMesh& socket_P, const Vec3& centre_P, Side side,
                       double half_slab = 2.0);

/// Neck-shaft angle, rad, in three dimensions: between the neck axis (towards the head) and the
/// shaft axis (downwards); the usual obtuse angle.
/// @param shaft_distal any vector along the shaft, pointing distally
double neck_shaft_angle(const Vec3& head_centre, const Vec3& neck_centre, const Vec3& shaft_distal);

struct AlphaAngleOptions {
  double tolerance =
      0.75;  ///< mm, > 0: the contour has left the sphere when it is farther than this
  double step = radians(0.5);       ///< rad, > 0, between rays
  double largest = radians(120.0);  ///< rad: where the search begins
};

/// Alpha angle (Notzli) in one half-plane through the neck axis, rad.
///
/// Going from the head towards the neck, the angle between the neck axis and the ray from the
/// head's centre to the first surface point that lies more than `tolerance` outside the head's
/// sphere.
/// @param femur   closed surface, mm         @param head  sphere of the head
/// @param neck    any vector from the head's centre along the neck axis
/// @param towards any vector on the side of the half-plane (anterior gives the classic angle)
/// @returns NaN when the contour never leaves the sphere
/// @throws Error bad_input if an option is out of range, or `towards` is along the neck
/// @note rays: the femur must be star-shaped about the head's centre where it is measured (head and
/// neck are)
double alpha_angle(const TriMesh& femur, const Sphere& head, const Vec3& neck, const Vec3& towards,
                   const AlphaAngleOptions& options = {});

}  // namespace coxa::measure
