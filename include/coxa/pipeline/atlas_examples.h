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
  std::vector<std::string> contrasts = {"t1",
                                        "dess"};  ///< of the images simulated to learn profiles
  int profile_hips = 6;    ///< >= 1: hips per contrast whose MRI is simulated to learn profiles
  double voxel = 0.8;      ///< mm, > 0, of those images
  std::uint64_t seed = 1;  ///< of their noise and surroundings
  /// Folders of one hip each that a user segmented: femur.ply, hip_bone.ply, … with the side in the
  /// folder's name.
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
