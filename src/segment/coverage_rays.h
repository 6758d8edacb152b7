#pragma once

#include <coxa/segment/layered_profile.h>
#include <coxa/segment/profile_search.h>

#include <span>

#include "host_patch.h"

namespace coxa::segment {

/// The profile at a vertex of a patch, in the image that blurs it least.
struct CoverageRay {
  std::size_t patch = 0, image = 0;
  Index vertex = 0;
  double rim_distance = 0.0;  ///< mm, as in the patch
  double blur = 0.0;          ///< mm, standard deviation along the normal
  VecX profile;
  LayerFit fit;
};

/// Rays of all vertices that an image shows.
/// @param blur by image: its standard deviation in half voxels
std::vector<CoverageRay> coverage_rays(std::span<const HostPatch> patches,
                                       std::span<const PreparedImage> images,
                                       std::span<const double> blur);

/// Fits layers to every ray, with brightnesses of the tissues taken from the rays beneath the
/// present layers, image by image. A ray of an image that shows too few of these loses its image's
/// opinion: it is taken out.
/// @returns the brightnesses, by image
std::vector<TissueBrightness> update_fits(std::vector<CoverageRay>& rays, std::size_t n_images);

/// Half a voxel along a unit normal, mm: a box of one and its linear interpolation have variance
/// spacing²/4.
double blur_along(const Volume& volume, const Vec3& normal);

/// The value at a share of the sorted values. @param values not empty
double quantile(std::vector<double> values, double share);

}  // namespace coxa::segment
