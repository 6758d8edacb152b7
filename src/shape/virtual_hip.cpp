#include <coxa/shape/virtual_hip.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/simplex_mesh.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/shape/build_atlas.h>
#include <coxa/shape/shape_modes.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <coxa/mesh/unfold.h>
#include <coxa/shape/hip_structures.h>
#include "cartilage_sheet.h"
#include "random_field.h"

namespace coxa::shape {
namespace {

constexpr double kLargestCoefficient = 2.5;
constexpr int kDraws = 30;
// thinning of overlapping cartilages
constexpr int kThinningRounds = 8;
constexpr double kLeastShareOfThickness = 0.3;
constexpr double kGapReach = 4.0;  // mm

Points surface_points(const SimplexMesh& topology, Points simplex) {
  SimplexMesh mesh = topology;
  mesh.points = std::move(simplex);
  return dual_surface(mesh).points;
}

TriMesh mean_surface(const StructureModel& model) {
  return dual_surface(model.hierarchy.levels.back());
}

VecX random_coefficients(const ShapeModes& modes, double spread, Rng& rng) {
  VecX coefficients(modes.deviations.size());
  for (Eigen::Index i = 0; i < coefficients.size(); ++i)
    coefficients[i] = spread * std::clamp(rng.normal(), -kLargestCoefficient, kLargestCoefficient);
  return coefficients;
}

TriMesh drawn_surface(const StructureModel& model, double spread, Rng& rng) {
  const SimplexMesh& finest = model.hierarchy.levels.back();
  const VecX coefficients = random_coefficients(model.shape, spread, rng);
  TriMesh surface;
  surface.points = surface_points(finest, shape_from(finest.points, model.shape, coefficients));
  surface.triangles = finest.faces_of;
  return surface;
}

Mat3 triangle_axes(const TriMesh& mesh, Index t) {
  const Vec3 a = mesh.points.row(mesh.triangles(t, 0)), b = mesh.points.row(mesh.triangles(t, 1)),
             c = mesh.points.row(mesh.triangles(t, 2));
  const Vec3 normal = (b - a).cross(c - a).stableNormalized(), along = (b - a).stableNormalized();
  Mat3 axes;
  axes << along, normal.cross(along), normal;
  return axes;
}

/// A cartilage as a sheet on the bone and what stands on it.
struct Layer {
  TriMesh sheet;  ///< bone side, normals into the bone
  Points across;  ///< per sheet vertex: from it to the articular side; 0 at the border
  ShellTopology shell;

  TriMesh surface() const {
    return {shell.points(sheet.points, sheet.points + across), shell.triangles};
  }
  /// The articular side alone, normals into the joint.
  TriMesh articular() const {
    TriMesh mesh{sheet.points + across, sheet.triangles};
    mesh.triangles.col(1).swap(mesh.triangles.col(2));
    return mesh;
  }
};

/// The mean sheet with the thickness of a drawn cartilage.
Layer drawn_layer(const StructureModel& model, double spread, Rng& rng) {
  const TriMesh mean = mean_surface(model), drawn = drawn_surface(model, spread, rng);
  Layer layer;
  layer.sheet.triangles = mean.triangles.topRows(model.n_bone_side);
  layer.sheet.points = mean.points.topRows(layer.sheet.triangles.maxCoeff() + 1);
  layer.shell = make_shell(layer.sheet);
  layer.across = Points::Zero(layer.sheet.points.rows(), 3);
  for (Index v = 0; v < layer.sheet.n_vertices(); ++v) {
    const Index opposite = layer.shell.articular_vertex[static_cast<std::size_t>(v)];
    if (opposite == v) continue;
    const Vec3 direction = mean.points.row(opposite) - mean.points.row(v);
    const double thickness = (drawn.points.row(opposite) - drawn.points.row(v)).norm();
    layer.across.row(v) = thickness * direction.stableNormalized();
  }
  return layer;
}

/// The layer keeps its place relative to the bone's triangles when the bone changes.
void update_carried(Layer& layer, const TriMesh& before, const TriMesh& now) {
  const TriangleTree tree(before.points, before.triangles);
  parallel_for(layer.sheet.n_vertices(), [&](Index v) {
    const NearestPoint near = tree.nearest(layer.sheet.points.row(v));
    const Mat3 turn =
        triangle_axes(now, near.triangle) * triangle_axes(before, near.triangle).transpose();
    Vec3 place = Vec3::Zero();
    for (int c = 0; c < 3; ++c)
      place += near.barycentric[c] * now.points.row(now.triangles(near.triangle, c)).transpose();
    const Vec3 off = layer.sheet.points.row(v).transpose() - near.point;
    layer.sheet.points.row(v) = place + turn * off;
    layer.across.row(v) = turn * layer.across.row(v).transpose();
  });
}

struct DrawnHip {
  std::map<std::string, TriMesh> bones;
  std::map<std::string, Layer> layers;
};

void update_mapped(Points& points, double scale, const Vec3& from, const Vec3& to) {
  points = (scale * (points.rowwise() - from.transpose())).rowwise() + to.transpose();
}

/// Scales and moves the pelvic part so that its articular sphere is that of the femur, a gap
/// larger.
void update_joint_fit(DrawnHip& hip, double gap) {
  Layer& socket = hip.layers.at("acetabular_cartilage");
  const Sphere head = fit_sphere(hip.layers.at("femoral_cartilage").articular().points);
  const Sphere cup = fit_sphere(socket.articular().points);
  const double scale = (head.radius + gap) / cup.radius;
  update_mapped(hip.bones.at("hip_bone").points, scale, cup.centre, head.centre);
  update_mapped(socket.sheet.points, scale, cup.centre, head.centre);
}

/// Draws the layer's articular side back by half of what the gap to `other` lacks.
/// @returns largest lack, mm
double thin(Layer& layer, const TriMesh& other, double gap) {
  const TriangleTree tree(other.points, other.triangles);
  const Points normals = triangle_normals(other);
  double worst = 0.0;
  for (Index v = 0; v < layer.sheet.n_vertices(); ++v) {
    const double thickness = layer.across.row(v).norm();
    const Vec3 p = layer.sheet.points.row(v) + layer.across.row(v);
    const auto near = tree.nearest_within(p, kGapReach);
    if (!near || thickness <= 0.0) continue;
    const Vec3 normal = normals.row(near->triangle);
    if (normal.dot(layer.across.row(v).transpose()) > 0.0) continue;  // not the side that faces it
    const double lack = gap - (p - near->point).dot(normal);
    if (lack <= 0.0 || lack > kGapReach) continue;
    worst = std::max(worst, lack);
    const double least = kLeastShareOfThickness * thickness;
    layer.across.row(v) *= std::max(least, thickness - 0.55 * lack) / thickness;
  }
  return worst;
}

bool opened(DrawnHip& hip, double gap) {
  Layer& head = hip.layers.at("femoral_cartilage");
  Layer& socket = hip.layers.at("acetabular_cartilage");
  for (int round = 0; round < kThinningRounds; ++round) {
    const TriMesh a = head.articular(), b = socket.articular();
    const double worst = std::max(thin(head, b, gap), thin(socket, a, gap));
    if (worst <= 0.5 * gap) return true;
  }
  return false;
}

DrawnHip draw_once(const Atlas& atlas, Rng& rng, const VirtualHipOptions& options) {
  DrawnHip hip;
  for (const StructureModel& model : atlas.structures) {
    if (model.n_bone_side == 0 && !model.muscle)
      hip.bones[model.name] = drawn_surface(model, options.spread, rng);
  }
  for (const StructureModel& model : atlas.structures) {
    if (model.n_bone_side == 0) continue;
    const std::string bone = bone_under(model.name);
    Layer layer = drawn_layer(model, options.spread, rng);
    const TriMesh mean = mean_surface(structure(atlas, bone));
    update_carried(layer, mean, hip.bones.at(bone));
    hip.layers[model.name] = std::move(layer);
  }
  return hip;
}

VirtualHip surfaces_of(const DrawnHip& hip) {
  VirtualHip surfaces = hip.bones;
  for (const auto& [name, layer] : hip.layers) surfaces[name] = layer.surface();
  return surfaces;
}

bool update_unfolded(VirtualHip& hip) {
  return std::all_of(hip.begin(), hip.end(),
                     [](auto& entry) { return coxa::update_unfolded(entry.second); });
}

void check(const VirtualHipOptions& options) {
  require(options.spread >= 0.0, "spread must not be negative, got ", options.spread);
  require(options.off_model_rms >= 0.0, "off_model_rms must not be negative, got ",
          options.off_model_rms, " mm");
  require(options.correlation > 0.0, "correlation must be positive, got ", options.correlation,
          " mm");
  require(options.least_gap >= 0.0, "least_gap must not be negative, got ", options.least_gap,
          " mm");
}

}  // namespace

VirtualHip mean_hip(const Atlas& atlas) {
  VirtualHip hip;
  for (const StructureModel& model : atlas.structures) {
    if (!model.muscle) hip[model.name] = mean_surface(model);
  }
  return hip;
}

VirtualHip draw_virtual_hip(const Atlas& atlas, Rng& rng, const VirtualHipOptions& options) {
  check(options);
  for (const char* name : kHipStructures) structure(atlas, name);
  for (int draw = 0; draw < kDraws; ++draw) {
    DrawnHip hip = draw_once(atlas, rng, options);
    update_joint_fit(hip, options.least_gap);
    if (!opened(hip, options.least_gap)) continue;
    VirtualHip surfaces = surfaces_of(hip);
    const RandomField field(options.off_model_rms, options.correlation, rng);
    for (auto& [name, mesh] : surfaces) {
      parallel_for(mesh.n_vertices(), [&mesh = mesh, &field](Index v) {
        mesh.points.row(v) += field(mesh.points.row(v));
      });
    }
    if (update_unfolded(surfaces)) return surfaces;
  }
  fail(ErrorCode::no_convergence, "no usable hip in ", kDraws, " draws with a spread of ",
       options.spread, " standard deviations: ask for less");
}

}  // namespace coxa::shape
