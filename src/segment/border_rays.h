#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/border_profile.h>
#include <coxa/segment/profile_search.h>

#include <map>
#include <span>
#include <utility>
#include <vector>

namespace coxa::segment {

/// The profile at a bone's vertex, in the image that blurs it least.
struct BorderRay {
  Index vertex = 0;
  std::size_t image = 0;
  double half_voxel = 0.0;  ///< mm, along the normal
  VecX profile;
  BorderFit fit;
};

/// Rays of all vertices that an image shows.
std::vector<BorderRay> border_rays(const TriMesh& bone, std::span<const PreparedImage> images);

/// What an image shows of bare bones.
struct BorderLook {
  BorderBrightness brightness;
  double blur_share = 1.0;  ///< standard deviation of the blur, in half voxels
};

/// Models for every blur that rays have.
class BorderModels {
 public:
  /// Takes the models that rays of one image need.
  void add(const std::vector<BorderRay>& rays, std::size_t image, const BorderLook& look);
  BorderFit fit(const BorderRay& ray, const BandPrior& prior = {}) const;
  bool has(std::size_t image) const { return share_.contains(image); }
  /// Standard deviation of an image's blur, in half voxels; 1 where it is not known.
  double blur_share(std::size_t image) const { return has(image) ? share_.at(image) : 1.0; }

 private:
  std::pair<std::size_t, long> key(const BorderRay& ray) const;
  std::map<std::size_t, double> share_;
  std::map<std::pair<std::size_t, long>, BorderModel> models_;
};

/// Fits every ray, with brightnesses, noise and blur that leave least of each image's clear rays
/// unexplained. Rays of an image that shows too few are taken out.
/// @param rays by bone
BorderModels fitted_models(std::vector<std::vector<BorderRay>>& rays, std::size_t n_images);

}  // namespace coxa::segment
