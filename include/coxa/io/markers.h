#pragma once

#include <coxa/motion/marker_data.h>

#include <filesystem>

namespace coxa::io {

/// Marker trajectories from a C3D, TRC or CSV file, told apart by the extension (any case); mm.
///
/// What is unusual but readable goes into `warnings`. CSV: columns `time_s`, then `NAME_x_mm
/// NAME_y_mm NAME_z_mm` per marker; empty cells where a marker was not seen.
/// @throws Error bad_file when the file is missing, of another kind, broken or cut short: the text
/// says where
motion::MarkerData read_markers(const std::filesystem::path& path);

/// C3D of all three processors (Intel, DEC, SGI), integer and real.
///
/// A point counts as not seen where its residual is negative, a coordinate is not finite, or all
/// three are exactly zero.
motion::MarkerData read_c3d(const std::filesystem::path& path);
/// OpenSim's and Cortex's tab-separated TRC; units mm, cm or m.
motion::MarkerData read_trc(const std::filesystem::path& path);
motion::MarkerData read_markers_csv(const std::filesystem::path& path);

void write_trc(const std::filesystem::path& path, const motion::MarkerData& markers);
void write_markers_csv(const std::filesystem::path& path, const motion::MarkerData& markers);

}  // namespace coxa::io
