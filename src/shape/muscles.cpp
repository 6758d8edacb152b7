#include <coxa/shape/muscles.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/thin_plate_spline.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/remesh.h>
#include <coxa/shape/shape_modes.h>
#include <coxa/shape/virtual_hip.h>

#include <algorithm>

#include "correspondence.h"
#include "make_model.h"

namespace coxa::shape {
namespace {

constexpr const char* kBones[] = {"femur", "hip_bone"};
// the mean femur ends in a flat cap: its vertices this near to the lowest are no anatomy, mm
constexpr double kCapHeight = 4.0;
// a mean bone's point this far from the example's bone after registration is not seen there, mm
constexpr double kSeenWithin = 1.5;

void check(const MuscleOptions& options) {
  require(options.triangle_area > 0.0, "triangle_area must be positive, got ",
          options.triangle_area);
  require(options.least_triangles >= 100 && options.most_triangles >= options.least_triangles,
          "muscles need at least 100 triangles, and most_triangles >= least_triangles");
  require(options.n_levels >= 3, "muscles need at least three levels, got ", options.n_levels);
  require(options.control_spacing > 0.0, "control_spacing must be positive, got ",
          options.control_spacing);
  require(options.control_smoothness >= 0.0, "control_smoothness must not be negative, got ",
          options.control_smoothness);
}

/// The mean bones, coarse, as what examples' bones are compared with.
std::vector<TrustedSurface> control_surfaces(const Atlas& atlas, double spacing) {
  std::vector<TrustedSurface> surfaces;
  for (const char* bone : kBones) {
    const TriMesh mean = dual_surface(structure(atlas, bone).hierarchy.levels.back());
    TrustedSurface surface{remesh(mean, {.target_edge = spacing}), {}};
    if (std::string(bone) == "femur") {
      const auto height = surface.mesh.points.col(2).array();
      surface.trust = (height > height.minCoeff() + kCapHeight).cast<double>();
    }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

void append(Points& points, const Points& more) {
  const auto n = points.rows();
  points.conservativeResize(n + more.rows(), 3);
  points.bottomRows(more.rows()) = more;
}

/// Takes the example's space to the atlas': its bones come to lie on the mean ones.
ThinPlateSpline carrier(const std::vector<TrustedSurface>& controls, const HipExample& example,
                        const MuscleOptions& options) {
  Points from(0, 3), to(0, 3);
  RegistrationOptions bones = options.registration;
  bones.similarity_iterations = RegistrationOptions{}.similarity_iterations;
  for (std::size_t b = 0; b < controls.size(); ++b) {
    const TrustedSurface& bone = example.surfaces.at(kBones[b]);
    const Points there = register_surface(controls[b], bone, bones);
    const VecX seen = observed_in(there, bone, kSeenWithin);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index v = 0; v < seen.size(); ++v) {
      const bool trusted = controls[b].trust.size() == 0 || controls[b].trust[v] > 0.0;
      if (seen[v] > 0.0 && trusted) rows.push_back(v);
    }
    append(from, there(rows, Eigen::all));
    append(to, controls[b].mesh.points(rows, Eigen::all));
  }
  return {from, to, options.control_smoothness};
}

/// The examples that show both bones and some muscle, muscles alone, in the atlas frame.
std::vector<HipExample> carried_examples(const Atlas& atlas,
                                         const std::vector<HipExample>& examples,
                                         const std::vector<std::string>& names,
                                         const MuscleOptions& options, const Monitor& monitor) {
  std::vector<TrustedSurface> controls;  // made for the first example that has muscles
  std::vector<HipExample> carried;
  for (const HipExample& example : examples) {
    HipExample muscles;
    muscles.name = example.name;
    if (!example.surfaces.count(kBones[0]) || !example.surfaces.count(kBones[1])) continue;
    for (const std::string& name : names) {
      const auto found = example.surfaces.find(name);
      if (found != example.surfaces.end()) muscles.surfaces.insert(*found);
    }
    if (muscles.surfaces.empty()) continue;
    monitor.check_cancelled();
    if (controls.empty()) controls = control_surfaces(atlas, options.control_spacing);
    const ThinPlateSpline map = carrier(controls, example, options);
    for (auto& [name, surface] : muscles.surfaces) surface.mesh.points = map(surface.mesh.points);
    carried.push_back(std::move(muscles));
  }
  return carried;
}

double edge_for(const TriMesh& mesh, const MuscleOptions& options) {
  const double wanted = area(mesh) / options.triangle_area;
  const auto n = static_cast<Index>(std::clamp(wanted, static_cast<double>(options.least_triangles),
                                               static_cast<double>(options.most_triangles)));
  return edge_length_for(mesh, n);
}

/// Of a muscle's examples: whole ones before cut ones, the first gives the template.
std::vector<HipExample> examples_of(const std::string& name,
                                    const std::vector<HipExample>& carried) {
  std::vector<HipExample> whole, cut;
  for (const HipExample& example : carried) {
    const auto found = example.surfaces.find(name);
    if (found == example.surfaces.end()) continue;
    auto& list = found->second.trust.size() == 0 ? whole : cut;
    list.push_back({example.name, {*found}, {}});
  }
  whole.insert(whole.end(), cut.begin(), cut.end());
  return whole;
}

}  // namespace

std::vector<CarriedMuscles> add_muscles(Atlas& atlas, const std::vector<HipExample>& examples,
                                        const std::vector<std::string>& names,
                                        const MuscleOptions& options, const Monitor& monitor) {
  check(options);
  const auto carried = carried_examples(atlas, examples, names, options, monitor);
  std::vector<CarriedMuscles> fitted;
  for (const HipExample& example : carried) fitted.push_back({example.name, {}});
  for (const std::string& name : names) {
    const auto own = examples_of(name, carried);
    if (own.empty()) continue;
    const StructureOptions size{edge_for(own.front().surfaces.at(name).mesh, options),
                                options.n_levels};
    const Correspondence all = correspond_bone(name, own, size, options.registration, monitor);
    const AlignedShapes aligned = align_shapes(all.vertices);
    Points middle = Points::Zero(all.vertices.front().rows(), 3);
    for (const Points& shape : all.vertices)
      middle += shape / static_cast<double>(all.vertices.size());
    const Similarity place = fit_similarity(aligned.mean, middle);
    const Points mean = transformed(place.scale * aligned.mean, place.X);
    atlas.structures.push_back(
        make_model(name, all, aligned, mean, {options.n_levels, options.variance_share}, monitor));
    atlas.structures.back().muscle = true;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const auto at = std::find_if(fitted.begin(), fitted.end(),
                                   [&](const CarriedMuscles& f) { return f.name == own[i].name; });
      at->surfaces[name] = {all.vertices[i], all.triangles};
    }
  }
  return fitted;
}

}  // namespace coxa::shape
