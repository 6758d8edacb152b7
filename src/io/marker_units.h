#pragma once

#include <coxa/motion/marker_data.h>

#include <string>

namespace coxa::io {

/// Scales the trajectories from `unit` (mm, cm, dm, m, in; any case) to mm.
///
/// Without a unit: metres if no coordinate reaches 20, else millimetres, and a warning says so.
/// @throws Error bad_file for a unit that is no length
void convert_to_mm(motion::MarkerData& markers, const std::string& unit, const std::string& file);

}  // namespace coxa::io
