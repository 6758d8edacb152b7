#include "layer_sheet.h"

namespace coxa::segment {

LayerSheet sheet_of(const TriMesh& layer, Index n_bone_side) {
  LayerSheet result;
  result.sheet.triangles = layer.triangles.topRows(n_bone_side);
  const Index n = result.sheet.triangles.maxCoeff() + 1;
  result.sheet.points = layer.points.topRows(n);
  result.opposite.resize(static_cast<std::size_t>(n));
  for (Index t = 0; t < n_bone_side; ++t) {
    for (int c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(layer.triangles(t, c));
      result.opposite[v] = layer.triangles(t + n_bone_side, (3 - c) % 3);
    }
  }
  return result;
}

VecX thickness_of(const LayerSheet& layer, const Points& points) {
  VecX thickness(layer.sheet.n_vertices());
  for (Index v = 0; v < thickness.size(); ++v)
    thickness[v] = (points.row(layer.opposite[static_cast<std::size_t>(v)]) - points.row(v)).norm();
  return thickness;
}

}  // namespace coxa::segment
