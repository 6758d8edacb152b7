#include <coxa/shape/build_atlas.h>

#include <coxa/core/error.h>
#include <coxa/shape/shape_modes.h>
#include <coxa/shape/virtual_hip.h>

#include "cartilage_place.h"
#include "correspondence.h"
#include "joint_fit.h"
#include "make_model.h"

namespace coxa::shape {
namespace {

/// Share of the examples that show each vertex: what few show hardly counts for pose and size.
VecX share_observed(const Correspondence& all) {
  VecX share = VecX::Zero(all.observed.front().size());
  for (const VecX& observed : all.observed) share += observed;
  return share / static_cast<double>(all.observed.size());
}

bool is_cartilage(const std::string& name) { return name.find("_cartilage") != std::string::npos; }

void check(const AtlasOptions& options) {
  require(options.cartilage_gap >= 0.0, "cartilage_gap must not be negative, got ",
          options.cartilage_gap);
  for (const auto& [name, structure] : options.structures) {
    require(structure.edge > 0.0, name, ": edge must be positive, got ", structure.edge);
    require(structure.n_levels >= 3, name, ": at least three levels, got ", structure.n_levels);
    require(!is_cartilage(name) || options.structures.count(bone_under(name)), name,
            " needs its bone among the structures");
  }
}

/// The bones of the atlas while it is built.
struct BuiltBone {
  Correspondence correspondence;
  TriMesh mean;
};

/// Finest vertices of the models nearest to the landmarks that lie on them.
void update_landmark_vertices(Atlas& atlas) {
  constexpr double kOnSurface = 3.0;  // mm
  for (StructureModel& model : atlas.structures) {
    if (model.n_bone_side > 0) continue;
    const Points& points = model.hierarchy.levels.back().points;
    for (const auto& [name, place] : atlas.landmarks) {
      Index nearest = 0;
      const double squared =
          (points.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
      if (squared < kOnSurface * kOnSurface) model.landmark_vertices[name] = nearest;
    }
  }
}

}  // namespace

std::string bone_under(const std::string& cartilage) {
  return cartilage == "femoral_cartilage" ? "femur" : "hip_bone";
}

Atlas build_atlas(const std::vector<HipExample>& examples, const AtlasOptions& options,
                  const Monitor& monitor) {
  check(options);
  Atlas atlas;
  std::map<std::string, BuiltBone> bones;
  for (const auto& [name, structure] : options.structures) {
    if (is_cartilage(name)) continue;
    BuiltBone bone;
    bone.correspondence = correspond_bone(name, examples, structure, options.registration, monitor);
    const Correspondence& all = bone.correspondence;
    const AlignedShapes aligned = align_shapes(all.vertices, share_observed(all));
    bone.mean = {aligned.mean, all.triangles};
    atlas.structures.push_back(make_model(name, all, aligned, aligned.mean,
                                          {structure.n_levels, options.variance_share}, monitor));
    bones[name] = std::move(bone);
  }
  for (const auto& [name, structure] : options.structures) {
    if (!is_cartilage(name)) continue;
    const Correspondence all = correspond_cartilage(name, bone_under(name), examples, structure,
                                                    options.registration, monitor);
    const AlignedShapes aligned = align_shapes(all.vertices);
    const BuiltBone& bone = bones.at(bone_under(name));
    const Points mean =
        placed_on_bone(aligned.mean, all, bone.mean, bone.correspondence, options.cartilage_gap);
    atlas.structures.push_back(make_model(name, all, aligned, mean,
                                          {structure.n_levels, options.variance_share}, monitor));
  }
  update_joint_fit(atlas, options.cartilage_gap);
  atlas.landmarks = find_landmarks(mean_hip(atlas));
  update_landmark_vertices(atlas);
  for (const HipExample& example : examples) atlas.subjects.push_back(example.name);
  return atlas;
}

}  // namespace coxa::shape
