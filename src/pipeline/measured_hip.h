#pragma once

#include <coxa/mesh/surface_set.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/pipeline/record.h>

#include <filesystem>

namespace coxa::pipeline {

/// What `measure` and `rom` read of a run: surfaces, side, head and frames.
struct MeasuredHip {
  Side side = Side::right;
  SurfaceSet surfaces;
  motion::JointCentre head;   ///< sphere of the femoral head about the frames' origin
  motion::BoneFrames frames;  ///< of the motion stage, or from the surfaces where it did not run
};

/// The folder that holds the segmentation: `segment` of a run, or the folder itself.
/// @throws Error bad_file if neither has one
std::filesystem::path segmentation_in(const std::filesystem::path& run_folder);

/// @throws Error bad_file if there is no segmentation; bad_input if no head is found
MeasuredHip read_measured_hip(const std::filesystem::path& run_folder, const Monitor& monitor);

/// Hashes of what `read_measured_hip` reads.
void add_measured_inputs(const std::filesystem::path& run_folder, Record& record);

}  // namespace coxa::pipeline
