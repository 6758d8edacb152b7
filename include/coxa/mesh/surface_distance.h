#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <functional>

namespace coxa {

/// Points spread evenly at random over the area of a surface.
Points sample_surface(const TriMesh& mesh, Index n, std::uint64_t seed);

struct SurfaceDistanceOptions {
  double samples_per_mm2 = 4.0;  ///< > 0
  Index max_samples =
      200000;  ///< >= 1 per surface; at least 2000 are taken where the maximum allows it
  std::uint64_t seed = 1;
  /// Only sample points where this is true are judged (field of view, region); empty: all.
  std::function<bool(const Vec3&)> within = {};
};

/// Distances between two surfaces from points sampled on both. mm.
struct SurfaceDistance {
  double assd = 0.0;  ///< average symmetric surface distance: mean of the two directed means
  double rms = 0.0;   ///< of both directions' distances
  double hd95 = 0.0;  ///< the larger of the two directed 95th percentiles
  double hd = 0.0;    ///< the largest distance found
  double bias =
      0.0;  ///< mean signed distance of the first surface's points to the second, positive outside
};

/// @param result, truth  surfaces in one frame; `truth` closed and outward for the bias to mean
/// anything
/// @throws Error bad_mesh if a surface has no triangle, bad_input if nothing of one lies `within`
/// @note bit-identical for any number of threads
SurfaceDistance surface_distance(const TriMesh& result, const TriMesh& truth,
                                 const SurfaceDistanceOptions& options = {});

/// 2 |A and B| / (|A| + |B|) of the volumes inside two closed surfaces, counted on a grid.
double volume_overlap(const TriMesh& a, const TriMesh& b, double spacing_mm);

}  // namespace coxa
