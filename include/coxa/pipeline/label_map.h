#pragma once

#include <coxa/image/volume.h>
#include <coxa/io/labels.h>
#include <coxa/mesh/surface_set.h>

namespace coxa::pipeline {

/// The voxels whose centres lie in each closed surface; where two overlap a cartilage wins over a
/// bone, a bone over labrum and ligaments, and these over a muscle.
/// @param grid  size, spacing, origin and direction of the result; its values are not read
io::LabelMap make_label_map(const Volume& grid, const SurfaceSet& surfaces);

}  // namespace coxa::pipeline
