#include <coxa/shape/build_atlas.h>

#include <coxa/core/error.h>
#include <coxa/mesh/hierarchy.h>
#include <coxa/mesh/remesh.h>
#include <coxa/shape/shape_modes.h>

namespace coxa::shape {
namespace {

/// The examples of one structure, in correspondence.
struct Corresponding {
  Triangles triangles;
  std::vector<Points> vertices;             ///< per example, hip frame
  std::vector<const HipExample*> examples;  ///< likewise
};

Points centroids(const Points& vertices, const Triangles& triangles) {
  Points points(triangles.rows(), 3);
  for (Index t = 0; t < triangles.rows(); ++t) {
    points.row(t) = (vertices.row(triangles(t, 0)) + vertices.row(triangles(t, 1)) +
                     vertices.row(triangles(t, 2))) /
                    3.0;
  }
  return points;
}

/// Trust of the remeshed template: that of the nearest vertex before.
VecX carried_trust(const TrustedSurface& from, const TriMesh& to) {
  if (from.trust.size() == 0) return {};
  VecX trust(to.n_vertices());
  for (Index v = 0; v < to.n_vertices(); ++v) {
    Index nearest = 0;
    (from.mesh.points.rowwise() - to.points.row(v)).rowwise().squaredNorm().minCoeff(&nearest);
    trust[v] = from.trust[nearest];
  }
  return trust;
}

Corresponding correspond(const std::string& name, const std::vector<HipExample>& examples,
                         const StructureOptions& structure, const RegistrationOptions& options,
                         const Monitor& monitor) {
  Corresponding all;
  for (const HipExample& example : examples) {
    if (example.surfaces.count(name)) all.examples.push_back(&example);
  }
  require(!all.examples.empty(), "no example has the structure ", name);
  const TrustedSurface& first = all.examples.front()->surfaces.at(name);
  TrustedSurface model;
  model.mesh = remesh(first.mesh, {.target_edge = structure.edge});
  model.trust = carried_trust(first, model.mesh);
  all.triangles = model.mesh.triangles;

  // first against the template, then against the mean
  const double n_fits = 2.0 * static_cast<double>(all.examples.size());
  for (int pass = 0; pass < 2; ++pass) {
    all.vertices.clear();
    for (std::size_t i = 0; i < all.examples.size(); ++i) {
      all.vertices.push_back(
          register_surface(model, all.examples[i]->surfaces.at(name), options, monitor));
      monitor.progress("atlas " + name,
                       (pass * n_fits / 2.0 + static_cast<double>(i) + 1.0) / n_fits);
    }
    model.mesh.points = align_shapes(all.vertices).mean;
  }
  return all;
}

SimplexMesh posed(const SimplexMesh& topology, Points points) {
  SimplexMesh mesh = topology;
  mesh.points = std::move(points);
  return mesh;
}

std::vector<ProfileSet> profiles_of(const Corresponding& all, const SimplexMesh& finest,
                                    const ProfileOptions& options) {
  std::map<std::string, std::vector<ProfileExample>> by_contrast;
  for (std::size_t i = 0; i < all.examples.size(); ++i) {
    const Points points = centroids(all.vertices[i], all.triangles);
    const Points normals = simplex_normals(posed(finest, points));
    for (const ExampleImage& image : all.examples[i]->images) {
      by_contrast[image.contrast].push_back({&image.volume, points, normals});
    }
  }
  std::vector<ProfileSet> sets;
  for (const auto& [contrast, list] : by_contrast)
    sets.push_back(learn_profiles(list, contrast, options));
  return sets;
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

StructureModel make_model(const std::string& name, const Corresponding& all,
                          const StructureOptions& structure, const AtlasOptions& options) {
  const AlignedShapes aligned = align_shapes(all.vertices);
  StructureModel model;
  model.name = name;
  model.hierarchy = make_hierarchy({aligned.mean, all.triangles}, {.n_levels = structure.n_levels});
  AlignedShapes simplex;
  for (const Points& shape : aligned.shapes)
    simplex.shapes.push_back(centroids(shape, all.triangles));
  simplex.mean = centroids(aligned.mean, all.triangles);
  model.shape = principal_modes(simplex, options.variance_share);
  const SimplexMesh& finest = model.hierarchy.levels.back();
  model.profiles = profiles_of(all, finest, options.profiles);
  model.reference = reference_parameters(finest);
  return model;
}

}  // namespace

Atlas build_atlas(const std::vector<HipExample>& examples, const AtlasOptions& options,
                  const Monitor& monitor) {
  Atlas atlas;
  std::map<std::string, TriMesh> means;
  for (const auto& [name, structure] : options.structures) {
    const Corresponding all = correspond(name, examples, structure, options.registration, monitor);
    atlas.structures.push_back(make_model(name, all, structure, options));
    means[name] = {align_shapes(all.vertices).mean, all.triangles};
  }
  atlas.landmarks = find_landmarks(means);
  for (const HipExample& example : examples) atlas.subjects.push_back(example.name);
  return atlas;
}

}  // namespace coxa::shape
