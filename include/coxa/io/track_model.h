#pragma once

#include <coxa/motion/hip_model.h>

#include <filesystem>

namespace coxa::io {

/// Calibration of one hip as JSON: `side` (right or left; right when absent),
/// `joint_centre_pelvis_mm`, `joint_centre_femur_mm`, `pelvis_landmarks_mm` and
/// `thigh_markers_femur_mm` (label -> [x, y, z]), and optionally `calibration_frame` (counted from
/// 1), `marker_sd_mm`, `pelvis_centre_sd_mm`, `femur_centre_sd_mm`, `source`.
/// @throws Error bad_file naming the key that is missing or wrong
motion::HipModel read_hip_model(const std::filesystem::path& path);
void write_hip_model(const std::filesystem::path& path, const motion::HipModel& model);

}  // namespace coxa::io
