#pragma once

#include <coxa/core/monitor.h>
#include <coxa/segment/profile_search.h>
#include <coxa/segment/segment.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// Where a hip was found without landmarks.
struct FoundPose {
  /// Best first: the fits at the place found between which the image hardly decides, such as turns
  /// of a round head; each per bone, finest mean points in the image.
  std::vector<std::vector<Points>> starts;
  Vec3 centre = Vec3::Zero();  ///< of the joint, LPS mm of the image searched
  std::string contrast;        ///< of the atlas, by which it was found
  double score = 0.0;          ///< mean correlation of the profiles in view after fitting, [-1, 1]
  double margin = 0.0;         ///< how far that is above the best other place
};

/// Where the atlas' landmarks lie with the bones placed, each carried by what of the bones' mean
/// shapes lies about it.
shape::Landmarks landmarks_at(const std::vector<Points>& placed,
                              const std::vector<const shape::StructureModel*>& bones,
                              const shape::Atlas& atlas);

/// Looks for a right hip in the images: the bones' mean shapes are tried all over the first image,
/// in several orientations and contrasts, and the best places refined by fitting the shape models.
/// @throws Error bad_input if the image is nowhere large enough to hold a hip; below_quality if no
/// place fits, or another one nearly as well
/// @note   seconds; bit-identical for any number of threads
FoundPose find_pose(const std::vector<const shape::StructureModel*>& bones,
                    const std::vector<PreparedImage>& images, const SegmentOptions& options,
                    const Monitor& monitor = {});

}  // namespace coxa::segment
