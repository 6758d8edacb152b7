#pragma once

#include <coxa/geom/clock_face.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

/// The bony rim of a socket, by direction about its axis.
///
/// A place is given by its angle about the axis (clock) and its height: the angle at the centre
/// from the pole of the socket (0) over its opening (about a right angle) outward.
struct SocketRim {
  /// 6 o'clock is the middle of the notch, as anatomists set it; 3 anterior.
  ClockFace clock;
  double radius = 0.0;  ///< mm, of the socket's articular surface
  std::vector<double>
      height;  ///< rad, of the bony edge, n evenly spaced hours from 12; NaN in the notch
  std::vector<double> cartilage;  ///< rad, of the cartilage's outer border; NaN where there is none
  std::vector<bool> covered;      ///< whether the horseshoe of cartilage reaches there
  double notch_begin = 0.0,
         notch_end = 0.0;  ///< hours, anterior and posterior end of the horseshoe

  Vec3 direction(double hour, double height) const;  ///< unit, from the centre
  /// Height of the edge at an hour, between its neighbours; across the notch on from both ends.
  double height_at(double hour) const;
  /// Likewise of the cartilage's border, but never beyond the edge where it is missing.
  double cartilage_at(double hour) const;
};

/// Finds the rim as the socket's horizon: seen from its centre, where bone ends.
///
/// @param hip_bone, cartilage  of a right hip, closed, outward, LPS mm; cartilage is the
/// acetabulum's
/// @throws Error bad_input if these are no socket with a horseshoe of cartilage
SocketRim find_socket_rim(const TriMesh& hip_bone, const TriMesh& cartilage);

}  // namespace coxa::shape
