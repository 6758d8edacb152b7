#pragma once

#include <coxa/image/volume.h>
#include <coxa/mesh/tri_mesh.h>

#include <cstdint>
#include <vector>

namespace coxa::segment {

/// Moves a closed surface until the voxels inside it are those of a mask, smoothly.
///
/// Both masks, the wanted one and the surface's own, are blurred by half a voxel; every vertex goes
/// along its normal by their difference, evened over the neighbours, again and again. Where they
/// agree nothing moves, so that what the mask does not change stays where it is within a voxel.
/// @param mask  1 inside, over the grid's voxels, x fastest   @param grid  its values are not read
/// @returns the Dice overlap that is reached
/// @throws Error bad_input if the mask is empty or of another size
double update_to_mask(TriMesh& mesh, const std::vector<std::uint8_t>& mask, const Volume& grid);

}  // namespace coxa::segment
