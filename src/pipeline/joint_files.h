#pragma once

#include <coxa/joint/joint_result.h>
#include <coxa/joint/simulate.h>

#include <filesystem>
#include <string>

namespace coxa::pipeline {

/// frames/acetabular_NNNN.vtu and femoral_NNNN.vtu of every converged frame, deformed, and
/// results.pvd over them; maxima_acetabular.vtu and maxima_femoral.vtu (and of the labrum): what
/// each node and element bore at most in any frame, on the undeformed meshes.
void write_frames(const std::filesystem::path& folder, const joint::JointModel& model,
                  const motion::HipMotion& motion, const joint::JointResult& result);

/// One line per frame: angles, status, pressures, areas, forces, strain by clock sector and region.
std::string summary_csv(const motion::HipMotion& motion, const joint::JointResult& result);

}  // namespace coxa::pipeline
