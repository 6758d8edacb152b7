#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::measure {

struct ThicknessOptions {
  double max_thickness = 8.0;  ///< mm. A ray that meets nothing this far gives NaN.
  double ray_offset = 1e-3;    ///< mm, in [0, max_thickness). Starts the ray clear of the bone.
};

/// Cartilage thickness at every vertex of a bone surface.
///
/// From each bone vertex one ray leaves along the unit normal; the thickness is the
/// distance to the first triangle of the articular surface it meets.
///
/// @param bone       bone surface (whole or a patch), V vertices, mm, oriented outward
/// @param articular  mesh of the articular surface, mm, in the same frame as `bone`
/// @returns          V values, mm; NaN where no cartilage covers the bone
/// @throws Error     bad_input if a mesh is empty or an option is out of range
/// @note             cost O(V log T); bit-identical for any number of threads
/// Source: ray definition (not nearest point, not Laplace), docs/measure.md section 2.
Eigen::VectorXd cartilage_thickness(const TriMesh& bone, const TriMesh& articular,
                                    const ThicknessOptions& options = {});

/// Thickness of a closed cartilage over its bone, at every bone vertex.
///
/// The same rays against the whole closed surface: the first triangle met within `max_thickness` of
/// the bone whose normal looks along the ray, so that a bone side lying a little off the bone does
/// not count as the articular one.
/// @returns V values, mm from the bone; NaN where no cartilage covers the bone
Eigen::VectorXd closed_cartilage_thickness(const TriMesh& bone, const TriMesh& cartilage,
                                           const ThicknessOptions& options = {});

}  // namespace coxa::measure
