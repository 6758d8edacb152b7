#pragma once

#include <coxa/segment/evolve.h>

#include <vector>

namespace coxa::segment {

/// Bones: the pose and modes first, then smooth deformations, in a smooth image; then freer, finer,
/// nearer.
/// @param range mm, search range of the first
std::vector<Resolution> bone_resolutions(double range);

/// Cartilages start on their segmented bone, so they have no far way to go.
std::vector<Resolution> layer_resolutions();

/// Of muscles that already lie about where the image shows muscle.
std::vector<Resolution> muscle_resolutions();

}  // namespace coxa::segment
