#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/profile_search.h>
#include <coxa/segment/uncertainty.h>

#include <span>
#include <vector>

namespace coxa::segment {

/// A bone's surface, to be moved, and the layers that lie on it.
struct BareBone {
  TriMesh* bone = nullptr;
  std::vector<const TriMesh*> layers;
  VecX deviation = {};  ///< found, per vertex, mm: of the border as the profiles about it tell it;
                        ///< kUnknownBorder where they tell nothing
};

/// Moves bones to the outer border of their cortex where nothing covers them, as the images'
/// brightness tells (border_profile.h); beneath layers and where no image shows it the surface only
/// follows what is beside.
///
/// A tendon or a capsule on the bone is as dark as its cortex, and the dark band wider than beside:
/// there the cortex is taken to be as thick as around.
/// @returns by image: standard deviation of its blur in half voxels, 1 where bones do not show it
std::vector<double> update_borders(std::vector<BareBone>& bones,
                                   std::span<const PreparedImage> images);

}  // namespace coxa::segment
