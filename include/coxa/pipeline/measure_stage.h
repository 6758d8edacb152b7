#pragma once

#include <coxa/core/monitor.h>
#include <coxa/measure/range_of_motion.h>
#include <coxa/measure/thickness.h>
#include <coxa/pipeline/stage.h>

#include <filesystem>

namespace coxa::pipeline {

/// Shape and thickness of a segmented hip, from the folder of a run (or of a segmentation alone),
/// into its subfolder `measure`: morphometry.csv with reference ranges, thickness.csv by clock
/// sector, femur.vtp and hip_bone.vtp with the field cartilage_thickness_mm, and measure.json.
///
/// Frames are those of the motion stage; without one they are made from the surfaces alone, and the
/// figures' intervals say so.
/// @throws Error bad_file if the folder holds no segmentation
Record run_measure_stage(const std::filesystem::path& run_folder,
                         const measure::ThicknessOptions& options, Reuse reuse,
                         const Monitor& monitor);

/// Range of motion until the bones first touch, into the subfolder `rom`: rom.csv and rom.json.
Record run_rom_stage(const std::filesystem::path& run_folder, const measure::RomOptions& options,
                     Reuse reuse, const Monitor& monitor);

}  // namespace coxa::pipeline
