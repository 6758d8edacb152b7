#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

/// A surface and how far its vertices are anatomy.
struct TrustedSurface {
  TriMesh mesh;  ///< closed, outward, mm
  VecX trust;    ///< V, 1 anatomy, 0 where a scan was cut off (flat caps); empty: all 1
};

struct RegistrationOptions {
  int similarity_iterations = 30;  ///< >= 0; 0 keeps pose and size
  /// mm, descending, > 0: standard deviations of the Gaussians that smooth the displacement field.
  std::vector<double> widths = {60.0, 30.0, 15.0, 8.0, 5.0};
  int iterations = 8;  ///< >= 1, at each width
  double normal_limit =
      0.5;  ///< cosine in [-1, 1): a pair whose normals are farther apart does not count
  double largest_distance = 25.0;  ///< mm, > 0: a pair farther apart does not count
};

/// Dense correspondence: where each vertex of `moving` lies on `target`.
///
/// Similarity, then ever finer smooth displacements pulled by nearest points both ways, with
/// compatible normals; a last projection onto the target where it is near. Where the target ends (a
/// cropped bone) the smooth displacement of the neighbourhood carries on.
/// @param moving, target roughly in the same place (a few cm, 20 degrees)
/// @returns V×3 positions
/// @note bit-identical for any number of threads
/// Source: coarse-to-fine non-rigid iterative closest points (Amberg et al. 2007, with Gaussian
/// instead of spring regularisation).
Points register_surface(const TrustedSurface& moving, const TrustedSurface& target,
                        const RegistrationOptions& options = {}, const Monitor& monitor = {});

/// Values at `points` of the displacement field known at `centres`, smoothed by a Gaussian of
/// `width` mm.
Points smooth_field(const Points& centres, const Points& displacements, const VecX& weights,
                    const Points& points, double width);

}  // namespace coxa::shape
