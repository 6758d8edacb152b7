#pragma once

#include <coxa/image/volume.h>

#include <cstdint>
#include <vector>

namespace coxa::segment {

/// A mask over a grid's voxels: 1 inside, x fastest.
using Mask = std::vector<std::uint8_t>;

/// Distance of every voxel's centre from the nearest centre in the mask, mm; infinity where the
/// mask is empty. Exact, in time proportional to the voxels (Felzenszwalb and Huttenlocher 2012).
/// @param grid  its values are not read
std::vector<float> distances_to(const Mask& mask, const Volume& grid);

/// Depth in the mask, mm: inside the distance from the nearest voxel outside, outside minus that
/// from the nearest inside. What lies beyond the grid counts as neither.
std::vector<float> depths_in(const Mask& mask, const Volume& grid);

}  // namespace coxa::segment
