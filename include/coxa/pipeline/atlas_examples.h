#pragma once

#include <coxa/core/monitor.h>
#include <coxa/shape/build_atlas.h>

#include <filesystem>
#include <string>
#include <vector>

namespace coxa::pipeline {

struct AtlasExampleOptions {
  /// Subjects left out, both sides: "m2", "vhf", "001".
  std::vector<std::string> exclude;
  /// Structures left out of a set, "set:structure", for example "libhip:hip_bone".
  std::vector<std::string> exclude_structures;
  /// Hips that a user segmented, one each: folders with femur.ply, hip_bone.ply, …, or label maps
  /// with the structures' names (`io::read_labels`). "left" or "right" is in the name of the file
  /// or its folder.
  std::vector<std::filesystem::path> own;
};

/// The example hips under `data` (the folders libhip, visible_human, labels/pelvic_ref), mirrored
/// to right hips with the femoral head centre at the origin, and MRI simulated from some of them.
///
/// Only real anatomy of permissive sets is taken: no hip bone that was warped from another
/// person's.
/// @throws Error bad_file if the folder has none of the sets; bad_input if an excluded name is not
/// in it
std::vector<shape::HipExample> load_atlas_examples(const std::filesystem::path& data,
                                                   const AtlasExampleOptions& options,
                                                   const Monitor& monitor = {});

}  // namespace coxa::pipeline
