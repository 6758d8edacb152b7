#pragma once

#include <coxa/image/volume.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace coxa::io {

/// One structure of a label map.
struct Label {
  int value = 1;  ///< 1 to 255
  std::string name;
  std::array<double, 3> colour{0.5, 0.5, 0.5};  ///< red, green, blue in [0, 1]
  bool generic = false;  ///< made from published anatomy, not seen in the image
};

/// Whole numbers on a grid, 0 background, and what they mean.
struct LabelMap {
  Volume volume;
  std::vector<Label> labels;  ///< by ascending value
};

/// Label map from `.seg.nrrd` (3D Slicer), or NIfTI with the names in a JSON beside it (same stem).
///
/// The JSON is what `write_labels` writes, or plainly {"1": "femur", …}. Without one the labels are
/// the values that occur, named label_1, label_2, …
/// @throws Error bad_file if missing or broken; bad_input if a voxel is not a whole number in [0,
/// 255]
LabelMap read_labels(const std::filesystem::path& path);

/// Writes `.seg.nrrd`, or `.nii`/`.nii.gz` and the JSON beside it.
/// @throws Error bad_input for another extension or a voxel without label; bad_file if it cannot be
/// written
void write_labels(const std::filesystem::path& path, const LabelMap& map);

}  // namespace coxa::io
