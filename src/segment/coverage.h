#pragma once

#include <coxa/segment/profile_search.h>

#include <span>
#include <vector>

#include "host_patch.h"

namespace coxa::segment {

/// What the images say about a layer on a patch of its host, per vertex of the patch.
struct Coverage {
  VecX score;      ///< in [-1, 1]: covered, bare; 0 where no image shows it
  VecX bone;       ///< mm outwards, where the host's border is beneath the layer
  VecX thickness;  ///< mm, as far as the brightness of the layer goes
  /// In [0, 1]: how far bone and thickness are to be believed; 0 where bare or not shown, below 1
  /// where the image is blurred along the normal.
  VecX known;
  /// In [0, 1]: share of vertices well inside and well outside the present layer that are told
  /// apart, 1/2 when by chance.
  double separation = 0.5;
  /// mm, width of the margin that is too thin to be seen, on the whole; the score there says bare.
  double hidden = 0.0;
};

/// Coverage of each patch by layered profiles along its normals.
/// @param blur by image: its standard deviation in half voxels
std::vector<Coverage> coverages_of(std::span<const HostPatch> patches,
                                   std::span<const PreparedImage> images,
                                   std::span<const double> blur);

}  // namespace coxa::segment
