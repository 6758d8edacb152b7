#include "make_model.h"

#include <coxa/geom/fits.h>
#include <coxa/mesh/hierarchy.h>
#include <coxa/mesh/unfold.h>

#include <cmath>

namespace coxa::shape {
namespace {

Points centroids(const Points& vertices, const Triangles& triangles) {
  Points points(triangles.rows(), 3);
  for (Index t = 0; t < triangles.rows(); ++t) {
    points.row(t) = (vertices.row(triangles(t, 0)) + vertices.row(triangles(t, 1)) +
                     vertices.row(triangles(t, 2))) /
                    3.0;
  }
  return points;
}

std::vector<SimplexParameters> reference_parameters(const SimplexMesh& mesh) {
  std::vector<SimplexParameters> parameters(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v), a = mesh.points.row(mesh.neighbours(v, 0)),
               b = mesh.points.row(mesh.neighbours(v, 1)),
               c = mesh.points.row(mesh.neighbours(v, 2));
    parameters[static_cast<std::size_t>(v)] = simplex_parameters(p, a, b, c);
  }
  return parameters;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? kNaN : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace

StructureModel make_model(const std::string& name, const Correspondence& all,
                          const AlignedShapes& aligned, const Points& mean,
                          const ModelOptions& options, const Monitor& monitor) {
  StructureModel model;
  model.name = name;
  model.n_bone_side = all.n_bone_side;
  TriMesh surface{mean, all.triangles};
  if (!update_unfolded(surface)) monitor.warn("the mean " + name + " cuts itself");
  model.hierarchy = make_hierarchy(surface, {.n_levels = options.n_levels});
  const Similarity to_atlas = fit_similarity(aligned.mean, mean);
  AlignedShapes simplex;
  for (const Points& shape : aligned.shapes) {
    simplex.shapes.push_back(
        centroids(transformed(to_atlas.scale * shape, to_atlas.X), all.triangles));
  }
  simplex.mean = centroids(transformed(to_atlas.scale * aligned.mean, to_atlas.X), all.triangles);
  model.shape = principal_modes(simplex, options.variance_share);
  model.leave_one_out_error = root_mean_square(leave_one_out_errors(simplex));
  model.reference = reference_parameters(model.hierarchy.levels.back());
  return model;
}

}  // namespace coxa::shape
