#include "joint_fit.h"

#include <coxa/geom/fits.h>

#include <string>

namespace coxa::shape {
namespace {

const StructureModel* find(const Atlas& atlas, const std::string& name) {
  for (const StructureModel& model : atlas.structures) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

Sphere articular_sphere(const StructureModel& cartilage) {
  return fit_sphere(cartilage.hierarchy.levels.back().points.bottomRows(cartilage.n_bone_side));
}

}  // namespace

void update_joint_fit(Atlas& atlas, double gap) {
  const StructureModel* on_head = find(atlas, "femoral_cartilage");
  const StructureModel* in_socket = find(atlas, "acetabular_cartilage");
  if (on_head == nullptr || in_socket == nullptr) return;
  const Sphere head = articular_sphere(*on_head), cup = articular_sphere(*in_socket);
  const double scale = (head.radius + gap) / cup.radius;
  for (StructureModel& model : atlas.structures) {
    if (model.name != "hip_bone" && model.name != "acetabular_cartilage") continue;
    for (SimplexMesh& level : model.hierarchy.levels) {
      level.points = (scale * (level.points.rowwise() - cup.centre.transpose())).rowwise() +
                     head.centre.transpose();
    }
    model.shape.deviations *= scale;
    model.leave_one_out_error *= scale;
  }
}

}  // namespace coxa::shape
