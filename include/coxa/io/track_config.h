#pragma once

#include <coxa/motion/track_setup.h>

#include <filesystem>
#include <optional>

namespace coxa::io {

/// How a recording is to be tracked, and the recording of the neutral pose where one is named.
struct TrackConfig {
  motion::TrackSetup setup;
  std::optional<std::filesystem::path> neutral_trial;
};

/// From TOML; all keys are optional and described in docs/motion.md. A `.json` file is a hip model
/// alone.
/// @throws Error bad_input naming a misspelt key, bad_file naming a file that is missing
TrackConfig read_track_config(const std::filesystem::path& path);

}  // namespace coxa::io
