#include <coxa/segment/body.h>

#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/vertex_normals.h>

#include <cmath>

#include <coxa/segment/force_field.h>

namespace coxa::segment {
namespace {

/// Rounds of giving back what the mean over a face takes from a displacement: three leave a
/// hundredth of one that varies over five edges, and amplify noise little.
constexpr int kGivingBack = 3;

/// Mean over the simplex vertices of each face.
Points face_means(const SimplexMesh& mesh, const Points& values) {
  Points sum = Points::Zero(mesh.n_faces, 3);
  VecX count = VecX::Zero(mesh.n_faces);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    for (int k = 0; k < 3; ++k) {
      sum.row(mesh.faces_of(v, k)) += values.row(v);
      count[mesh.faces_of(v, k)] += 1.0;
    }
  }
  return count.cwiseMax(1.0).cwiseInverse().asDiagonal() * sum;
}

/// Mean over the three faces of each simplex vertex.
Points vertex_means(const SimplexMesh& mesh, const Points& values) {
  Points means(mesh.n_vertices(), 3);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    means.row(v) = (values.row(mesh.faces_of(v, 0)) + values.row(mesh.faces_of(v, 1)) +
                    values.row(mesh.faces_of(v, 2))) /
                   3.0;
  }
  return means;
}

// twice volume over area is a layer's thickness; no cartilage is as thick as this, no bone as thin,
// mm
constexpr double kThickestLayer = 4.0;
// a layer's two borders are a millimetre or two apart and much alike over some millimetres: noise
// of single vertices is averaged over this distance (standard deviation, mm) before it can fold a
// rim
constexpr double kLayerSmoothing = 2.5;
// vertices whose normals differ more (cosine) lie on the other face
constexpr double kSameFace = 0.5;

bool is_layer(const TriMesh& surface) {
  return 2.0 * volume(surface) / area(surface) < kThickestLayer;
}

Points smoothed_on_one_face(const TriMesh& surface, const Points& field) {
  const Points normals = vertex_normals(surface);
  const double reach = 3.0 * kLayerSmoothing, factor = -0.5 / (kLayerSmoothing * kLayerSmoothing);
  Points out(field.rows(), 3);
  parallel_for(field.rows(), [&](Index v) {
    Vec3 sum = Vec3::Zero();
    double total = 0.0;
    for (Index w = 0; w < field.rows(); ++w) {
      const double squared = (surface.points.row(v) - surface.points.row(w)).squaredNorm();
      if (squared > reach * reach || normals.row(v).dot(normals.row(w)) < kSameFace) continue;
      const double weight = std::exp(factor * squared);
      sum += weight * field.row(w).transpose();
      total += weight;
    }
    out.row(v) = sum / total;
  });
  return out;
}

}  // namespace

SimplexMesh finest_mesh(const Body& body) {
  SimplexMesh mesh = body.model->hierarchy.levels.back();
  mesh.points = body.points;
  return mesh;
}

TriMesh surface_mesh(const Body& body) {
  SimplexMesh mesh = body.model->hierarchy.levels.back();
  mesh.points = body.fit.points;
  TriMesh surface = dual_surface(mesh);
  const Points displacement = body.points - body.fit.points;
  Points moved = Points::Zero(mesh.n_faces, 3);
  for (int round = 0; round <= kGivingBack; ++round) {
    moved += face_means(mesh, displacement - vertex_means(mesh, moved));
  }
  if (is_layer(surface)) moved = smoothed_on_one_face(surface, moved);
  surface.points += moved;
  update_unfolded(surface);
  return surface;
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

Body placed_body(const shape::StructureModel& model, Points placed) {
  Body body;
  body.model = &model;
  body.fit = fit_model(model, placed, VecX::Ones(placed.rows()), 1.0);
  body.points = body.fit.points;
  return body;
}

}  // namespace coxa::segment
