#pragma once

#include <coxa/geom/triangle_tree.h>
#include <coxa/segment/profile_search.h>

#include <span>
#include <vector>

namespace coxa::segment {

/// A way from one bone's border through both layers to the other's.
struct GapRay {
  Index vertex = 0;       ///< of the patch it starts from
  Vec3 place, direction;  ///< the border, and the unit way to the other bone
  double room = 0.0;      ///< mm, from border to border
};

/// Where two layers part on a way, as an image shows it.
struct GapFit {
  double middle = 0.0;           ///< mm from the ray's place
  double deviation = kInfinity;  ///< mm, root mean square by which everything tried differs from
                                 ///< it; infinite where nothing is told
  double width = 0.0;            ///< mm, if what is between is twice as bright as the layers
};

/// The thin bright line (fluid in a gradient echo) between two layers that nearly touch, thinner
/// than the image resolves.
///
/// Between the borders a profile is explained as one bright layer between dark cortices, whose
/// edges are blurred and may be a little off, and a line of unknown strength at a place that is
/// tried on a grid. Images in which most lines are dark tell nothing: there it is too faint.
/// @param blur by image: standard deviation in half voxels
std::vector<GapFit> gaps_between(std::span<const GapRay> rays,
                                 std::span<const PreparedImage> images,
                                 std::span<const double> blur);

}  // namespace coxa::segment
