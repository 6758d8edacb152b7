#include "labrum_body.h"

#include <coxa/geom/triangle_tree.h>

#include <algorithm>

namespace coxa::joint {
namespace {

// a labrum without tags is held where it lies on the bone or in it, as near as surfaces segmented
// apart from each other may be, mm
constexpr double kSeat = 0.3;

}  // namespace

std::vector<Index> labrum_seat(const JointModel& model) {
  const TetMesh& mesh = model.labrum_body;
  const bool tagged = mesh.facet_tags.size() == static_cast<std::size_t>(mesh.facets.rows()) &&
                      facets_with(mesh, FacetTag::bone_side).rows() > 0;
  std::vector<Index> seat;
  if (tagged) {
    const Triangles facets = facets_with(mesh, FacetTag::bone_side);
    seat.assign(facets.data(), facets.data() + facets.size());
  } else if (!model.hip_bone.empty()) {
    const TriangleTree bone(model.hip_bone.points, model.hip_bone.triangles);
    for (const Index node : mesh.facets.reshaped()) {
      if (bone.nearest_within(mesh.points.row(node), kSeat)) seat.push_back(node);
    }
  }
  std::sort(seat.begin(), seat.end());
  seat.erase(std::unique(seat.begin(), seat.end()), seat.end());
  return seat;
}

LabrumBody::LabrumBody(const JointModel& model, Index first)
    : model_(model),
      first_(first),
      held_(labrum_seat(model)),
      elasticity_(model.labrum_body, first, model.labrum_material) {
  const Triangles& facets = model.labrum_body.facets;
  std::vector<Index> free;
  for (Index f = 0; f < facets.rows(); ++f) {
    const auto nodes = facets.row(f);
    const auto is_held = [&](Index node) {
      return std::binary_search(held_.begin(), held_.end(), node);
    };
    if (!std::all_of(nodes.begin(), nodes.end(), is_held)) free.push_back(f);
  }
  surface_ = (facets(free, Eigen::all).array() + first).matrix();
  for (Index& node : held_) node += first;
}

}  // namespace coxa::joint
