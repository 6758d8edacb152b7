#pragma once

#include <coxa/image/volume.h>
#include <coxa/mesh/surface_set.h>

#include <map>
#include <string>

namespace coxa::pipeline {

/// A label map and what its numbers mean.
struct LabelMap {
  Volume volume;                      ///< whole numbers; 0 background
  std::map<std::string, int> labels;  ///< structure -> number
};

/// The voxels whose centres lie in each closed surface; where two overlap the later structure in
/// label order wins (cartilages over bones).
/// @param grid  size, spacing, origin and direction of the result; its values are not read
LabelMap make_label_map(const Volume& grid, const SurfaceSet& surfaces);

}  // namespace coxa::pipeline
