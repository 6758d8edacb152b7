#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

struct CarveOptions {
  double gap = 0.15;          ///< mm, >= 0, kept from every obstacle
  double spacing = 0.4;       ///< mm, > 0, of the grid; what is left thinner than it is lost
  double edge = 1.0;          ///< mm, > 0, of the new triangles
  double least_kept = 0.7;    ///< share of the volume, in (0, 1], that must be left
  double least_whole = 0.95;  ///< share of that, in [0, 1], that one piece must be; others are
                              ///< lost, unless it is 0: then all stay
  double rounding = 1.0;      ///< grid steps, > 0: radius of the rims of what was cut
  bool anew = false;          ///< new triangles even where nothing is in the way
};

/// What a closed surface encloses less what lies in the obstacles or nearer to them than the gap.
///
/// The distances of all are compared on a grid, and the zero level of their least is remeshed: the
/// outcome cannot fold, however the surfaces cross, and clears flat triangles as well as vertices.
/// @param obstacles closed, outward
/// @returns closed, outward; the surface as it is where nothing of it is in the way, unless `anew`
/// @throws Error below_quality if less than `least_kept` of the volume is left, or that is in
/// pieces
TriMesh carved(const TriMesh& mesh, const std::vector<const TriMesh*>& obstacles,
               const CarveOptions& options = {});

}  // namespace coxa::shape
