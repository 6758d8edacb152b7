#include <coxa/segment/pins.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/segment/lay_on_hosts.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "interpolated.h"

namespace coxa::segment {
namespace {

constexpr double kSupport = 25.0;  // mm, of what a pin pulls along
// mm inside kPinExtent where layers laid anew pass into those that stay
constexpr double kSeam = 3.0;
// relative size below which two pins are one: they share what they ask for
constexpr double kSamePin = 1e-6;

/// Where a pin takes hold of its surface, and where that place is to go.
struct Anchor {
  Vec3 place, normal, target;
  Index triangle;
  Vec3 barycentric;
};

Anchor anchor_of(const Pin& pin, const TriMesh& mesh, const TriangleTree& tree,
                 const Points& normals) {
  require(pin.weight >= 0.0 && pin.weight <= 1.0, "the weight of pin ", pin.name,
          " must be in [0, 1], got ", pin.weight);
  const NearestPoint near = tree.nearest(pin.place);
  const double distance = std::sqrt(near.squared_distance);
  require(distance <= kPinReach, "pin ", pin.name, " lies ", distance, " mm from the ",
          pin.structure, "; pins are taken up to ", kPinReach, " mm from their surface");
  return {near.point, interpolated(normals, mesh.triangles, near).normalized(),
          near.point + pin.weight * (pin.place - near.point), near.triangle, near.barycentric};
}

/// Wendland's function of the distance, times one that is 1 where both places face alike and 0
/// where they face away: a product of positive definite kernels.
double kernel(const Vec3& a, const Vec3& normal_a, const Vec3& b, const Vec3& normal_b) {
  const double r = (a - b).norm() / kSupport;
  if (r >= 1.0) return 0.0;
  const double alike = 0.5 * (1.0 + normal_a.dot(normal_b));
  return std::pow(1.0 - r, 4) * (4.0 * r + 1.0) * alike * alike;
}

/// Moves one surface; @returns the places that were pulled.
std::vector<Anchor> update_by_pins(TriMesh& mesh, const std::vector<Pin>& pins) {
  const TriangleTree tree(mesh.points, mesh.triangles);
  const Points normals = vertex_normals(mesh);
  std::vector<Anchor> anchors;
  for (const Pin& pin : pins) anchors.push_back(anchor_of(pin, mesh, tree, normals));
  const auto n = static_cast<Eigen::Index>(anchors.size());
  const auto at_vertex = [&](Index v, const Anchor& anchor) {
    return kernel(mesh.points.row(v), normals.row(v), anchor.place, anchor.normal);
  };
  // how each anchor's place on its triangle moves with the strength of each pin
  MatX influence = MatX::Zero(n, n);
  Points wanted(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Anchor& here = anchors[static_cast<std::size_t>(i)];
    wanted.row(i) = here.target - here.place;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (int k = 0; k < 3; ++k) {
        influence(i, j) += here.barycentric[k] * at_vertex(mesh.triangles(here.triangle, k),
                                                           anchors[static_cast<std::size_t>(j)]);
      }
    }
  }
  Eigen::CompleteOrthogonalDecomposition<MatX> solver;
  solver.setThreshold(kSamePin);
  solver.compute(influence);
  const Points strength = solver.solve(MatX(wanted));
  Points points = mesh.points;
  parallel_for(mesh.n_vertices(), [&](Index v) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double share = at_vertex(v, anchors[static_cast<std::size_t>(j)]);
      if (share > 0.0) points.row(v) += share * strength.row(j);
    }
  });
  mesh.points = std::move(points);
  update_unfolded(mesh);
  return anchors;
}

/// A layer goes with its bone: each vertex as far as the bone's place nearest to it.
void update_carried(TriMesh& layer, const TriMesh& before, const Points& after) {
  const TriangleTree tree(before.points, before.triangles);
  const Points moves = after - before.points;
  Points points = layer.points;
  parallel_for(layer.n_vertices(), [&](Index v) {
    const NearestPoint near = tree.nearest(layer.points.row(v));
    points.row(v) += interpolated(moves, before.triangles, near).transpose();
  });
  layer.points = std::move(points);
}

/// Takes back what is far from all anchors.
void keep_far(TriMesh& mesh, const Points& before, const std::vector<Anchor>& anchors) {
  parallel_for(mesh.n_vertices(), [&](Index v) {
    double nearest = kInfinity;
    for (const Anchor& anchor : anchors)
      nearest = std::min(nearest, (Vec3(before.row(v)) - anchor.place).norm());
    const double share = std::clamp((kPinExtent - nearest) / kSeam, 0.0, 1.0);
    if (share == 1.0) return;
    const Vec3 move = mesh.points.row(v) - before.row(v);
    mesh.points.row(v) = before.row(v);
    if (share > 0.0) mesh.points.row(v) += share * move.transpose();
  });
}

void lay_layers(SurfaceSet& surfaces, const std::map<std::string, std::string>& host_of,
                double gap) {
  std::vector<LaidLayer> layers;
  for (const auto& [layer, host] : host_of) {
    if (surfaces.contains(layer) && surfaces.contains(host))
      layers.push_back({&surfaces.at(layer).mesh, &surfaces.at(host).mesh, 0});
  }
  lay_on_hosts(layers, gap);
}

using PinsOf = std::map<std::string, std::vector<Pin>>;

PinsOf by_structure(const SurfaceSet& surfaces, const std::vector<Pin>& pins) {
  PinsOf pins_of;
  for (const Pin& pin : pins) {
    require(surfaces.contains(pin.structure), "pin ", pin.name, " is for the structure ",
            pin.structure, ", which is not segmented");
    pins_of[pin.structure].push_back(pin);
  }
  return pins_of;
}

/// From each pin's target to its surface as it is now.
std::map<std::string, double> distances_left(const SurfaceSet& before, const SurfaceSet& now,
                                             const PinsOf& pins_of) {
  const auto tree = [](const TriMesh& mesh) { return TriangleTree(mesh.points, mesh.triangles); };
  std::map<std::string, double> distances;
  for (const auto& [name, pins] : pins_of) {
    const TriangleTree then = tree(before.at(name).mesh), moved = tree(now.at(name).mesh);
    for (const Pin& pin : pins) {
      const Vec3 from = then.nearest(pin.place).point;
      const Vec3 target = from + pin.weight * (pin.place - from);
      distances[pin.name] = std::sqrt(moved.nearest(target).squared_distance);
    }
  }
  return distances;
}

}  // namespace

std::map<std::string, double> update_pinned(SurfaceSet& surfaces, const std::vector<Pin>& pins,
                                            const std::map<std::string, std::string>& host_of,
                                            double gap) {
  if (pins.empty()) return {};
  const PinsOf pins_of = by_structure(surfaces, pins);
  const SurfaceSet before = surfaces;
  std::vector<Anchor> anchors;
  const auto pull = [&](bool layers) {
    for (const auto& [name, own] : pins_of) {
      if (host_of.contains(name) != layers) continue;
      const auto more = update_by_pins(surfaces.at(name).mesh, own);
      anchors.insert(anchors.end(), more.begin(), more.end());
    }
  };
  pull(false);
  for (const auto& [layer, host] : host_of) {
    if (surfaces.contains(layer) && pins_of.contains(host))
      update_carried(surfaces.at(layer).mesh, before.at(host).mesh, surfaces.at(host).mesh.points);
  }
  pull(true);
  lay_layers(surfaces, host_of, gap);
  for (auto& [name, surface] : surfaces)
    keep_far(surface.mesh, before.at(name).mesh.points, anchors);
  return distances_left(before, surfaces, pins_of);
}

}  // namespace coxa::segment
