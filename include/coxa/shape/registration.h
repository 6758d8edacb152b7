#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

/// A surface and how far its vertices are anatomy.
struct TrustedSurface {
  TriMesh mesh;  ///< outward, mm; closed, or a sheet with borders
  VecX trust;    ///< V, 1 anatomy, 0 where a scan was cut off (flat caps); empty: all 1
};

struct RegistrationOptions {
  int similarity_iterations = 15;  ///< >= 0; 0 keeps pose and size
  /// mm, descending, > 0: lengths over which the deformation is stiff, one stage each.
  std::vector<double> lengths = {120.0, 60.0, 30.0, 15.0, 6.0, 3.0};
  int iterations = 4;  ///< >= 1, at each length
  double normal_limit =
      0.5;  ///< cosine in [-1, 1): a pair whose normals are farther apart does not count
  double largest_distance = 25.0;  ///< mm, > 0: a pair farther apart does not count
};

/// Dense correspondence: where each vertex of `moving` lies on `target`.
///
/// Similarity, then an ever softer elastic surface pulled by nearest points both ways, with
/// compatible normals; borders are pulled to borders; a last projection onto the target where it is
/// near. Where the target ends (a cropped bone) the elastic surface carries on.
/// @param moving, target roughly in the same place (a few cm, 20 degrees)
/// @returns V×3 positions
/// @throws Error bad_input for options out of range, bad_mesh for an empty surface
/// @note bit-identical for any number of threads
/// Source: coarse-to-fine non-rigid iterative closest points (Amberg et al. 2007), with the
/// as-rigid-as-possible energy of Sorkine and Alexa 2007 and a size per vertex.
Points register_surface(const TrustedSurface& moving, const TrustedSurface& target,
                        const RegistrationOptions& options = {}, const Monitor& monitor = {});

/// The elastic stages alone, from a registration already near: strain is counted from `moving`.
/// @param start V×3, mm
Points refine_registration(const TrustedSurface& moving, const Points& start,
                           const TrustedSurface& target, const RegistrationOptions& options = {},
                           const Monitor& monitor = {});

/// The similarity of the first stage alone: `moving`'s vertices in its pose and size on `target`.
Points register_similarity(const TrustedSurface& moving, const TrustedSurface& target,
                           const RegistrationOptions& options = {});

}  // namespace coxa::shape
