#include "label_map_bones.h"

#include <coxa/image/volume.h>
#include <coxa/io/volumes.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/topology.h>

#include <algorithm>
#include <map>

namespace coxa::pipeline {
namespace {

constexpr float kPelvis = 1.0F, kFemur = 2.0F;
// the step of a 3 mm slice is smoothed away, a 1 mm edge hardly moves
constexpr double kSmoothing = 1.2;  // mm
constexpr double kGrid = 1.5;       // mm, of the surface's grid
constexpr double kCutReach = 3.0;   // mm from the middle plane: not anatomy

double middle_of(const Volume& labels, float label) {
  double sum = 0.0, count = 0.0;
  for (Index k = 0; k < labels.size[2]; ++k) {
    for (Index j = 0; j < labels.size[1]; ++j) {
      for (Index i = 0; i < labels.size[0]; ++i) {
        if (labels.values[static_cast<std::size_t>(labels.offset(i, j, k))] != label) continue;
        sum += labels.position(Vec3(i, j, k)).x();
        count += 1.0;
      }
    }
  }
  return sum / count;
}

Volume mask_of(const Volume& labels, float label, Side side, double middle) {
  Volume mask = labels;
  for (Index k = 0; k < labels.size[2]; ++k) {
    for (Index j = 0; j < labels.size[1]; ++j) {
      for (Index i = 0; i < labels.size[0]; ++i) {
        const auto at = static_cast<std::size_t>(labels.offset(i, j, k));
        const bool on_left = labels.position(Vec3(i, j, k)).x() > middle;
        mask.values[at] =
            labels.values[at] == label && on_left == (side == Side::left) ? 1.0F : 0.0F;
      }
    }
  }
  return mask;
}

}  // namespace

TriMesh largest_piece(const TriMesh& mesh) {
  const std::vector<Index> piece = triangle_components(mesh);
  std::map<Index, Index> sizes;
  for (const Index p : piece) ++sizes[p];
  const auto largest = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    if (piece[static_cast<std::size_t>(t)] == largest->first) kept.push_back(t);
  }
  return sub_mesh(mesh, kept).mesh;
}

double middle_of_pelvis(const Volume& labels) { return middle_of(labels, kPelvis); }

TriMesh surface_of_mask(const Volume& mask) {
  const Volume smooth = smoothed(resampled_isotropic(mask, kGrid), kSmoothing);
  return largest_piece(iso_surface(smooth.size, smooth.values, 0.5,
                                   [&](const Vec3& i) { return smooth.position(i); }));
}

LabelledBones bones_from_labels(const std::filesystem::path& path, Side side) {
  const Volume labels = io::read_volume(path);
  const double middle = middle_of_pelvis(labels);
  LabelledBones bones;
  bones.hip_bone = surface_of_mask(mask_of(labels, kPelvis, side, middle));
  bones.femur = surface_of_mask(mask_of(labels, kFemur, side, middle));
  bones.hip_bone_trust =
      ((bones.hip_bone.points.col(0).array() - middle).abs() > kCutReach).cast<double>();
  return bones;
}

}  // namespace coxa::pipeline
