#pragma once

#include <coxa/shape/atlas.h>

#include <filesystem>

namespace coxa::io {

/// Reads an atlas that `write_atlas` wrote.
/// @throws Error bad_file if it is missing, broken, cut short, or of a newer format
shape::Atlas read_atlas(const std::filesystem::path& path);

/// Writes a compressed binary file: positions as 32-bit floats (0.01 µm at 100 mm), modes as 16-bit
/// and profiles as 8-bit fractions of their columns' largest values. The reference parameters are
/// those of the mean shape and are not stored.
void write_atlas(const std::filesystem::path& path, const shape::Atlas& atlas);

}  // namespace coxa::io
