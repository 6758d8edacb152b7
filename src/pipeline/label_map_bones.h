#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <coxa/image/volume.h>

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

/// x of the middle plane of the pelvis in a label map, LPS mm.
double middle_of_pelvis(const Volume& labels);

/// The connected piece with most triangles.
TriMesh largest_piece(const TriMesh& mesh);

/// Surface of a mask's largest piece, the steps of thick slices smoothed away.
TriMesh surface_of_mask(const Volume& mask);

}  // namespace coxa::pipeline
