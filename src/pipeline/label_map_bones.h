#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <filesystem>

namespace coxa::pipeline {

/// Bones of one side from a label map of the whole pelvis.
struct LabelledBones {
  TriMesh hip_bone, femur;  ///< LPS mm
  VecX hip_bone_trust;      ///< 0 at the cut through the symphysis
};

/// Smooth surfaces of labels 1 (pelvis) and 2 (femur), both sides under one number, cut at the
/// body's middle.
LabelledBones bones_from_labels(const std::filesystem::path& path, Side side);

}  // namespace coxa::pipeline
