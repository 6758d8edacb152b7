#pragma once

#include <coxa/segment/body.h>
#include <coxa/segment/segment.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// What a size far from the atlas' mean costs of a place's mean correlation: adults' hips differ by
/// 7 %, and half the evidence of a right place (0.2) buys three standard deviations. Small bones
/// fit anywhere.
double size_cost(double scale);

/// What a turn from the atlas' orientation costs: patients lie alike within some ten degrees, and
/// round bones fit in any turn.
double turn_cost(const Mat3& R);

/// The bones at one place of an image, each fitted by its own shape model.
struct PlacedBones {
  std::vector<Body> bodies;
  std::string contrast;
  double score = 0.0;  ///< mean correlation in view, less what size and a dislocated joint cost
};

/// Mean of where the bones have the joint's centre, LPS mm.
Vec3 joint_centre(const PlacedBones& place);

/// The bones' mean shapes at a pose of their common frame, not fitted yet.
PlacedBones placed_bones(const std::vector<const shape::StructureModel*>& bones,
                         const Similarity& pose, const std::string& contrast);

/// How far off the bones may be, and how much of the image they are fitted to.
struct PlaceFit {
  double range = 0.0;   ///< mm
  double sigma = 0.0;   ///< mm, of the image's smoothing
  double window = 0.0;  ///< mm, extent of the profiles that count
};

/// Fits every bone from where it is.
/// @param image  smoothed as `fit` says
void update_placed(PlacedBones& place, PreparedImage image, const PlaceFit& fit,
                   const SegmentOptions& options);

}  // namespace coxa::segment
