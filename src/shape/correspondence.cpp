#include "correspondence.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/remesh.h>
#include <coxa/shape/shape_modes.h>

#include <cmath>

#include "cartilage_sheet.h"

namespace coxa::shape {
namespace {

// a vertex this near to a trusted place of the example has been seen there, mm
constexpr double kObservedWithin = 1.0;
// lengths (mm) from which the second pass, mean shape against example, starts
constexpr double kSecondPassFrom = 30.0;

std::vector<const HipExample*> examples_with(const std::string& name,
                                             const std::vector<HipExample>& examples) {
  std::vector<const HipExample*> found;
  for (const HipExample& example : examples) {
    if (example.surfaces.count(name)) found.push_back(&example);
  }
  require(!found.empty(), "no example has the structure ", name);
  return found;
}

/// Trust of the remeshed template: that of the nearest vertex before.
VecX carried_trust(const TrustedSurface& from, const TriMesh& to) {
  if (from.trust.size() == 0) return {};
  const TriangleTree tree(from.mesh.points, from.mesh.triangles);
  VecX trust(to.n_vertices());
  parallel_for(to.n_vertices(), [&](Index v) {
    const NearestPoint near = tree.nearest(to.points.row(v));
    double least = 1.0;
    for (int c = 0; c < 3; ++c) {
      if (near.barycentric[c] > 0.0)
        least = std::min(least, from.trust[from.mesh.triangles(near.triangle, c)]);
    }
    trust[v] = least;
  });
  return trust;
}

RegistrationOptions second_pass(const RegistrationOptions& options) {
  RegistrationOptions second = options;
  std::erase_if(second.lengths, [](double length) { return length > kSecondPassFrom; });
  if (second.lengths.empty()) second.lengths = options.lengths;
  return second;
}

/// First the template against every target, then the mean of these.
std::vector<Points> register_all(const TrustedSurface& model,
                                 const std::vector<TrustedSurface>& targets,
                                 const RegistrationOptions& options, const std::string& name,
                                 const Monitor& monitor) {
  std::vector<Points> fits;
  const double n = 2.0 * static_cast<double>(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    fits.push_back(register_surface(model, targets[i], options, monitor));
    monitor.progress("atlas " + name, (static_cast<double>(i) + 1.0) / n);
  }
  TrustedSurface mean = model;
  mean.mesh.points = align_shapes(fits).mean;
  const RegistrationOptions second = second_pass(options);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    fits[i] = refine_registration(mean, fits[i], targets[i], second, monitor);
    monitor.progress("atlas " + name, 0.5 + (static_cast<double>(i) + 1.0) / n);
  }
  return fits;
}

CartilageSides sides_of(const HipExample& example, const std::string& name,
                        const std::string& bone) {
  const TriMesh& shell = example.surfaces.at(name).mesh;
  const auto known = example.bone_side_faces.find(name);
  if (known != example.bone_side_faces.end()) return split_cartilage(shell, known->second);
  const auto host = example.surfaces.find(bone);
  require(host != example.surfaces.end(), example.name, ": which side of the ", name,
          " lies on the bone is not known: give the ", bone, " too");
  return split_cartilage(shell, host->second.mesh);
}

}  // namespace

VecX observed_in(const Points& points, const TrustedSurface& example, double reach) {
  const TriangleTree tree(example.mesh.points, example.mesh.triangles);
  VecX observed = VecX::Zero(points.rows());
  parallel_for(points.rows(), [&](Index v) {
    const auto near = tree.nearest_within(points.row(v), reach);
    if (!near) return;
    bool trusted = true;
    for (int c = 0; c < 3 && example.trust.size() > 0; ++c)
      trusted = trusted && example.trust[example.mesh.triangles(near->triangle, c)] > 0.0;
    observed[v] = trusted ? 1.0 : 0.0;
  });
  return observed;
}

Correspondence correspond_bone(const std::string& name, const std::vector<HipExample>& examples,
                               const StructureOptions& structure,
                               const RegistrationOptions& options, const Monitor& monitor) {
  Correspondence all;
  all.examples = examples_with(name, examples);
  const TrustedSurface& first = all.examples.front()->surfaces.at(name);
  TrustedSurface model;
  model.mesh = remesh(first.mesh, {.target_edge = structure.edge});
  model.trust = carried_trust(first, model.mesh);
  all.triangles = model.mesh.triangles;
  std::vector<TrustedSurface> targets;
  for (const HipExample* example : all.examples) targets.push_back(example->surfaces.at(name));
  all.vertices = register_all(model, targets, options, name, monitor);
  for (std::size_t i = 0; i < targets.size(); ++i)
    all.observed.push_back(observed_in(all.vertices[i], targets[i], kObservedWithin));
  return all;
}

Correspondence correspond_cartilage(const std::string& name, const std::string& bone,
                                    const std::vector<HipExample>& examples,
                                    const StructureOptions& structure,
                                    const RegistrationOptions& options, const Monitor& monitor) {
  Correspondence all;
  all.examples = examples_with(name, examples);
  std::vector<TriMesh> articular;
  std::vector<TrustedSurface> targets;
  // the sheet with edges nearest to those asked for is the template
  std::size_t best = 0;
  for (const HipExample* example : all.examples) {
    const CartilageSides sides = sides_of(*example, name, bone);
    targets.push_back({sides.bone_side, {}});
    articular.push_back(sides.articular);
    const auto misses = [&](std::size_t i) {
      return std::abs(std::log(mean_edge_length(targets[i].mesh) / structure.edge));
    };
    if (misses(targets.size() - 1) < misses(best)) best = targets.size() - 1;
  }
  const TriMesh sheet = without_border_chords(targets[best].mesh);
  const ShellTopology shell = make_shell(sheet);
  all.triangles = shell.triangles;
  all.n_bone_side = sheet.n_triangles();
  const std::vector<Points> sheets = register_all({sheet, {}}, targets, options, name, monitor);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const Points opposite = opposite_points({sheets[i], sheet.triangles}, articular[i]);
    all.vertices.push_back(shell.points(sheets[i], opposite));
    all.observed.push_back(VecX::Ones(shell.n_vertices));
  }
  return all;
}

}  // namespace coxa::shape
