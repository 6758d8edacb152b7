#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/profile_search.h>

#include <vector>

namespace coxa::segment {

/// Likeness of an image's voxels to a tissue, by brightness: 1 at its most common one.
struct TissueBrightness {
  double level = 0.0;   ///< median inside
  double spread = 1.0;  ///< standard deviation by the median absolute deviation
  double likeness(double value) const;
};

/// Brightness of a tissue from places that show it; robust against a third of them being others.
TissueBrightness tissue_brightness(std::vector<double> values);

struct TissueWarpOptions {
  std::vector<double> grids = {6.0, 3.0};  ///< mm, > 0, coarse first
  int iterations = 60;                     ///< >= 1, on each grid
  double margin = 25.0;                    ///< mm of image around the bodies
  double update_smoothing = 1.5;           ///< grid steps, of each update
  double total_smoothing = 1.0;            ///< grid steps, of the whole displacement
};

/// Moves bodies of one tissue, all by one smooth displacement, so that together they cover what
/// looks like that tissue in the image.
///
/// Their union, less the obstacles, is one image; the likeness to the tissue's brightness found
/// inside them is the other, blank inside the obstacles. Between these, demons forces with both
/// images' gradients, smoothed (Thirion 1998; Vercauteren et al. 2009). Places outside the view are
/// carried along.
/// @param bodies    closed surfaces, mm, roughly in place
/// @param obstacles closed surfaces that neither move nor are covered
/// @param points    what to move, one matrix per entry
/// @returns the moved points; as they are where the bodies lie outside the image
std::vector<Points> moved_to_tissue(const std::vector<TriMesh>& bodies,
                                    const std::vector<TriMesh>& obstacles,
                                    const PreparedImage& image, const std::vector<Points>& points,
                                    const TissueWarpOptions& options = {},
                                    const Monitor& monitor = {});

}  // namespace coxa::segment
