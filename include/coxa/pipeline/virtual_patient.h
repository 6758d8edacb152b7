#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/phantom.h>
#include <coxa/pipeline/record.h>
#include <coxa/shape/virtual_hip.h>

#include <filesystem>

namespace coxa::pipeline {

/// Other voxels, noise, shading, texture and fat shift than those of the images that profiles were
/// learned on.
PhantomOptions unlike_training();

struct VirtualPatientRequest {
  std::filesystem::path atlas;
  Side side = Side::right;
  std::uint64_t seed = 1;
  shape::VirtualHipOptions shape = {.spread = 0.8, .off_model_rms = 1.5};
  PhantomOptions image = unlike_training();
  double landmark_error = 2.0;  ///< mm, standard deviation of the landmarks written, >= 0
};

/// Draws a patient that nobody has into `folder`: image.nii.gz, landmarks.mrk.json,
/// truth/<structure>.ply and a subject.toml ready for `coxa run`, with the record phantom.json.
Record make_virtual_patient(const VirtualPatientRequest& request,
                            const std::filesystem::path& folder, const Monitor& monitor);

}  // namespace coxa::pipeline
