#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/profile_search.h>

#include <span>
#include <vector>

namespace coxa::segment {

/// A closed layer of cartilage on its bone; both are changed.
struct ExtentLayer {
  TriMesh* layer = nullptr;
  TriMesh* host = nullptr;
  Index n_bone_side = 0;  ///< first triangles of the layer, on the host; triangle i + n_bone_side
                          ///< lies opposite triangle i
};

inline constexpr double kTellsApart = 0.78;

/// What has become of a layer.
struct FoundExtent {
  double separation = 0.5;  ///< share of places well inside and outside that the images tell apart
  bool folds = false;       ///< the layer found would cut itself
  bool changed() const { return separation >= kTellsApart && !folds; }
};

/// Where layers end on their bones, how thick they are, and where the bones' borders are beneath
/// them, as the images' brightness tells (layered_profile.h).
///
/// Along a bone's normals covered and bare places are told apart; the rim is moved along the bone
/// to where they part; the bone beneath takes the place of its border, the layer the thickness
/// found. Where two layers touch without anything between, the images show the sum of both only: it
/// is shared as the layers have it now.
/// @param blur by image: its standard deviation in half voxels
/// A layer stays as it is where the images tell fewer than `kTellsApart` of the places apart, or
/// where the new one would cut itself.
std::vector<FoundExtent> update_extents(std::vector<ExtentLayer>& layers,
                                        std::span<const PreparedImage> images,
                                        std::span<const double> blur);

}  // namespace coxa::segment
