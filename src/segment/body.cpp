#include <coxa/segment/body.h>

#include <coxa/segment/force_field.h>

namespace coxa::segment {

SimplexMesh finest_mesh(const Body& body) {
  SimplexMesh mesh = body.model->hierarchy.levels.back();
  mesh.points = body.points;
  return mesh;
}

Points field_at_level(const SimplexHierarchy& hierarchy, std::size_t level, const Points& field,
                      const VecX& weight) {
  Points values = field;
  VecX weights = weight;
  for (std::size_t l = hierarchy.levels.size() - 1; l > level; --l) {
    const Index n = hierarchy.levels[l - 1].n_vertices();
    Points column = Points::Zero(weights.size(), 3);
    column.col(0) = weights;
    values = restricted(values, weights, hierarchy.maps[l - 1], n);
    weights = restricted(column, VecX::Ones(column.rows()), hierarchy.maps[l - 1], n).col(0);
  }
  return values;
}

VecX values_at_level(const SimplexHierarchy& hierarchy, std::size_t level, const VecX& values) {
  Points column = Points::Zero(values.size(), 3);
  column.col(0) = values;
  return field_at_level(hierarchy, level, column, VecX::Ones(values.size())).col(0);
}

Points field_at_finest(const SimplexHierarchy& hierarchy, std::size_t level, const Points& field) {
  Points values = field;
  for (std::size_t l = level; l + 1 < hierarchy.levels.size(); ++l) {
    values = prolonged(values, hierarchy.maps[l]);
  }
  return values;
}

Points posed(const Points& points, const Similarity& pose) {
  return transformed(pose.scale * points, pose.X);
}

Points level_points(const SimplexHierarchy& hierarchy, std::size_t level, const Points& fine,
                    const Similarity& pose) {
  if (level + 1 == hierarchy.levels.size()) return fine;
  const Points displacement = fine - posed(hierarchy.levels.back().points, pose);
  return posed(hierarchy.levels[level].points, pose) +
         field_at_level(hierarchy, level, displacement, VecX::Ones(fine.rows()));
}

}  // namespace coxa::segment
