#pragma once

#include <coxa/shape/atlas.h>

#include <filesystem>

namespace coxa::io {

/// Reads an atlas that `write_atlas` wrote.
/// @throws Error bad_file if it is missing, broken, cut short, or of a newer format
shape::Atlas read_atlas(const std::filesystem::path& path);

/// Writes a compressed binary file: positions as 32-bit floats (0.01 µm at 100 mm), modes and
/// profiles as 16-bit fractions of their largest value (1/32767).
void write_atlas(const std::filesystem::path& path, const shape::Atlas& atlas);

}  // namespace coxa::io
