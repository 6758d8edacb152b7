#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <cstdint>
#include <vector>

namespace coxa::medial {

/// Which of the two faces of a sheet-like body a surface triangle belongs to.
enum class SideLabel : std::int8_t { first = 0, second = 1, rim = 2 };

/// A closed surface cut into the two faces of its sheet and the rim between them.
struct SurfaceSides {
  std::vector<SideLabel> labels;  ///< per triangle
  VecX thickness;  ///< per triangle: inward ray length, mm; NaN where it meets nothing
  double relative_thickness = 0.0;  ///< median thickness over the square root of half the area
  double sheetness =
      0.0;  ///< share of the area that faces the other side across the body, in [0, 1]
};

/// Splits a closed surface into two opposing faces and a rim.
///
/// Finds the signed function on the triangles that varies least along the surface, may jump at
/// sharp edges, and takes opposite values where an inward ray meets the surface again: the lowest
/// eigenvector of a signed Laplacian. Where it changes sign is the rim of a knife edge; triangles
/// there without a partner (walls, crests) form the rim band.
///
/// @param surface  closed, oriented outward, mm
/// @throws Error   bad_mesh if the surface is open or not manifold
/// @note           cost: T rays and one sparse factorisation; bit-identical for any number of
/// threads
SurfaceSides split_sides(const TriMesh& surface);

/// What `split_sides` finds at most, for the T rays only: what faces another part of the surface
/// need not be a sheet.
struct FacingBound {
  double sheetness = 0.0;           ///< at least that of the sides, in [0, 1]
  double relative_thickness = 0.0;  ///< that of the sides
};
/// @throws Error bad_mesh if the surface is open or not manifold
FacingBound facing_bound(const TriMesh& surface);

}  // namespace coxa::medial
