#pragma once

#include <coxa/segment/distance_map.h>
#include <coxa/segment/tissue_warp.h>

#include <vector>

namespace coxa::segment {

/// Between which brightnesses muscle lies; nowhere if `high` is not above `low`.
struct MuscleRange {
  TissueBrightness muscle;
  double low = 0.0, high = 0.0;
};

/// @param values brightness by voxel   @param depth  in the deepest body there, mm, negative
/// outside
/// @param bone   voxels of other bodies   @param claim  mm about the bodies to look at
/// @returns an empty range if what is about the bodies is not clearly brighter than they are
MuscleRange muscle_range(const std::vector<float>& values, const std::vector<float>& depth,
                         const Mask& bone, double claim);

/// Voxels of muscle, by brightness and thickness.
Mask muscle_tissue(const std::vector<float>& values, const std::vector<float>& depth,
                   const MuscleRange& range, const Mask& bone, const Volume& grid, double claim);

}  // namespace coxa::segment
