#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/profile_search.h>
#include <coxa/segment/random_walker.h>

#include <cstdint>
#include <vector>

namespace coxa::segment {

/// How many voxels in view a body had and got.
struct LabelledBody {
  std::int64_t in_view = 0;   ///< in its surface as given
  std::int64_t labelled = 0;  ///< with its label
  std::int64_t both = 0;

  /// Voxels with its label for each that it had.
  double shown() const { return static_cast<double>(labelled) / static_cast<double>(in_view); }
  /// Dice overlap of its place and its label.
  double overlap() const {
    return 2.0 * static_cast<double>(both) / static_cast<double>(in_view + labelled);
  }
};

/// Which of several bodies each voxel of a grid belongs to.
struct BodyLabels {
  Volume grid;                       ///< axes of the image; its values are not used
  std::vector<int> label;            ///< by voxel, x fastest: number of the body, -1: of none
  std::vector<LabelledBody> bodies;  ///< empty where nothing could be labelled
};

struct MuscleLabelOptions {
  double finest = 1.0;      ///< mm, > 0: of the grid; coarser where the image is
  double softness = 2.0;    ///< mm, > 0, over which a body's border is in doubt
  double claim = 20.0;      ///< mm, > 0, from a body within which tissue may be of it
  double far_share = 1e-3;  ///< of a body outside of itself, e times less for each far_length
  double far_length = 4.0;  ///< mm, > 0
  WalkOptions walk = {};
};

/// Shares out what looks like muscle between bodies that lie roughly in place.
///
/// Muscle is by its brightness nearer to what lies deep in the bodies than to the bright tissue
/// about them, no rim of a bone and no skin. Its voxels are labelled by random walks (see
/// `likeliest_labels`) with each body's place as prior; a step towards brighter tissue, such as fat
/// between two muscles, is the less likely the brighter it is. So a border is where the image shows
/// one, else where the bodies have it; and what lies beyond a body's end, but is linked with it and
/// with no other, is of it.
/// @param firm closed surfaces that are not muscle
/// @returns nothing labelled where what is about the bodies is not clearly brighter, or out of view
BodyLabels muscle_labels(const std::vector<TriMesh>& bodies, const std::vector<TriMesh>& firm,
                         const PreparedImage& image, const MuscleLabelOptions& options = {},
                         const Monitor& monitor = {});

}  // namespace coxa::segment
