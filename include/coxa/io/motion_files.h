#pragma once

#include <coxa/motion/hip_motion.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/motion/track.h>

#include <filesystem>
#include <vector>

namespace coxa::io {

/// Writes a movement as CSV, one line per frame: frame, time_s, flexion_deg, adduction_deg,
/// internal_rotation_deg, head_x_mm head_y_mm head_z_mm (laboratory; pelvis axes from the joint
/// centre where the movement has no laboratory), translation_{anterior,superior,right}_mm (head
/// from the joint centre, pelvis axes) and, where known, *_interval_deg. Comment lines (#) before
/// the header name method and warnings.
void write_motion(const std::filesystem::path& path, const motion::HipMotion& motion);

/// Reads what `write_motion` wrote, or any CSV with time_s and the three angle columns.
/// @throws Error bad_file naming the line or the missing column
motion::HipMotion read_motion(const std::filesystem::path& path, Side side);

/// OpenSim motion file: time, hip_flexion_SIDE, hip_adduction_SIDE, hip_rotation_SIDE in degrees.
/// OpenSim's gait models turn the hip in the same sequence (z, x, y) and count the same directions
/// as positive.
void write_opensim_motion(const std::filesystem::path& path, const motion::HipMotion& motion,
                          Side side);

/// Residuals as CSV: frame, time_s, then one column LABEL_mm per thigh marker.
void write_residuals(const std::filesystem::path& path, const motion::TrackResult& result);

/// Estimates of the joint centre side by side as CSV: definition, x_mm y_mm z_mm (in the frame they
/// were made in), radius_mm, rms_mm, covered_share, interval_mm, region.
void write_joint_centres(const std::filesystem::path& path,
                         const std::vector<motion::JointCentre>& centres);

/// What the laboratory marked in time and what was found, as CSV: time_s, label, context, source;
/// in the order of time.
void write_events(const std::filesystem::path& path,
                  const std::vector<motion::MarkerEvent>& events);

}  // namespace coxa::io
