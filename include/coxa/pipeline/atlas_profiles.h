#pragma once

#include <coxa/core/monitor.h>
#include <coxa/shape/atlas.h>
#include <coxa/shape/muscles.h>

#include <string>
#include <vector>

namespace coxa::pipeline {

struct AtlasProfileOptions {
  std::vector<std::string> contrasts = {"t1", "dess"};  ///< among t1, t2, pd, dess
  int n_hips = 2;          ///< >= 1: virtual hips per class of profiles
  double voxel = 1.1;      ///< mm, > 0, of their images
  double snr = 40.0;       ///< > 0, of their images
  std::uint64_t seed = 1;  ///< of the hips, their surroundings and noise
};

/// Learns the atlas' intensity profiles from simulated MRI of virtual hips drawn from it.
///
/// Each contrast gives two classes: "t1", where the cartilages touch, and "t1_fluid", where fluid
/// parts them.
/// @throws Error bad_input for an unknown contrast or an option out of range
void update_atlas_profiles(shape::Atlas& atlas, const AtlasProfileOptions& options,
                           const Monitor& monitor = {});

/// Learns the profiles of the muscles, one set per contrast, from noise-free images simulated of
/// the mean and of the examples that have nearly all muscles, in the atlas frame.
void update_muscle_profiles(shape::Atlas& atlas, const std::vector<shape::CarriedMuscles>& examples,
                            const AtlasProfileOptions& options, const Monitor& monitor = {});

}  // namespace coxa::pipeline
