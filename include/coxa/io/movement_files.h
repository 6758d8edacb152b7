#pragma once

#include <coxa/motion/clinical_pattern.h>

#include <filesystem>

namespace coxa::io {

/// A clinical movement from TOML: `name`, `description`, `source`, `interpolation` (smooth, linear,
/// periodic), and four lists of equal length: `time_s`, `flexion_deg`, `adduction_deg`,
/// `internal_rotation_deg`.
/// @throws Error bad_file or bad_input naming file and key
motion::ClinicalPattern read_pattern(const std::filesystem::path& path);
void write_pattern(const std::filesystem::path& path, const motion::ClinicalPattern& pattern);

}  // namespace coxa::io
