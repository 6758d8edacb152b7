#include <coxa/segment/lay_on_hosts.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/unfold.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/segment/part_bodies.h>

#include <algorithm>
#include <cmath>

#include "interpolated.h"

namespace coxa::segment {
namespace {

// height of a seated vertex, mm: the two triangulations of one curved surface lie apart by as much
constexpr double kSeat = 0.05;
// a height above the host is believed up to this much beyond the layer's own thickness, mm
constexpr double kFloating = 0.3;
// layers and bones farther than this are not each other's neighbours, mm
constexpr double kReach = 12.0, kLayerReach = 4.0;

// laid layers enter their hosts and each other by less than a millimetre, between vertices; pushed
// 0.03 mm clear on a lattice of points they do not between these either
constexpr Parting kParting{
    .gap = 0.03, .tolerance = 0.01, .deepest = 1.5, .reach = 1.5, .near = 0.3};

/// Where each vertex of a layer stands on its host.
struct Footing {
  Points foot, normal;       // of the host
  std::vector<bool> facing;  // whether the vertex belongs to the side that faces the host
  VecX thickness;            // mm; 0 where facing
};

/// The triangles whose corners all do (or all do not) face the host.
Triangles one_side(const Triangles& triangles, const std::vector<bool>& facing, bool wanted) {
  std::vector<Index> kept;
  for (Index t = 0; t < triangles.rows(); ++t) {
    bool all = true;
    for (int k = 0; k < 3; ++k)
      all = all && facing[static_cast<std::size_t>(triangles(t, k))] == wanted;
    if (all) kept.push_back(t);
  }
  return triangles(kept, Eigen::all);
}

Footing footing_of(const TriMesh& layer, const TriMesh& host) {
  const TriangleTree tree(host.points, host.triangles);
  const Points host_normals = vertex_normals(host), normals = vertex_normals(layer);
  const Index n = layer.n_vertices();
  Footing footing{Points(n, 3), Points(n, 3), {}, VecX::Zero(n)};
  VecX height(n);
  parallel_for(n, [&](Index v) {
    const Vec3 p = layer.points.row(v);
    const NearestPoint near = tree.nearest(p);
    footing.foot.row(v) = near.point;
    footing.normal.row(v) = interpolated(host_normals, host.triangles, near).normalized();
    height[v] = (p - near.point).dot(footing.normal.row(v));
  });
  for (Index v = 0; v < n; ++v)
    footing.facing.push_back(normals.row(v).dot(footing.normal.row(v)) < 0.0);
  const Triangles seated = one_side(layer.triangles, footing.facing, true);
  if (seated.rows() == 0) return footing;
  const TriangleTree underside(layer.points, seated);
  parallel_for(n, [&](Index v) {
    if (footing.facing[static_cast<std::size_t>(v)]) return;
    const double own =
        std::sqrt(underside.nearest(layer.points.row(v).transpose()).squared_distance);
    footing.thickness[v] = std::clamp(height[v] - kSeat, 0.0, own + kFloating);
  });
  return footing;
}

/// Thickness of another layer where it faces a point; 0 where none does.
class ThicknessAt {
 public:
  ThicknessAt(const TriMesh& layer, const Footing& footing)
      : triangles_(one_side(layer.triangles, footing.facing, false)),
        thickness_(footing.thickness) {
    if (triangles_.rows() > 0) tree_.emplace(layer.points, triangles_);
  }
  double operator()(const Vec3& p) const {
    const auto near = tree_ ? tree_->nearest_within(p, kLayerReach) : std::nullopt;
    return near ? interpolated(thickness_, triangles_, *near) : 0.0;
  }

 private:
  Triangles triangles_;
  VecX thickness_;
  std::optional<TriangleTree> tree_;
};

/// The share of the room between the hosts that a layer may fill.
double allowed(double own, double other, double room) {
  if (own + other <= room || own == 0.0) return own;
  return std::max(0.0, room) * own / (own + other);
}

double part_layers(const std::vector<LaidLayer>& layers) {
  std::vector<SoftBody> soft;
  std::vector<const TriMesh*> firm;
  for (const LaidLayer& l : layers) {
    soft.push_back({l.layer, l.n_bone_side});
    if (std::find(firm.begin(), firm.end(), l.host) == firm.end()) firm.push_back(l.host);
  }
  return update_parted(soft, firm, kParting);
}

}  // namespace

double lay_on_hosts(std::vector<LaidLayer>& layers, double gap) {
  std::vector<Footing> footings;
  std::vector<ThicknessAt> thickness;
  std::vector<TriangleTree> hosts;
  for (const LaidLayer& l : layers) {
    footings.push_back(footing_of(*l.layer, *l.host));
    thickness.emplace_back(*l.layer, footings.back());
    hosts.emplace_back(l.host->points, l.host->triangles);
  }
  std::vector<Points> laid;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const Footing& footing = footings[l];
    Points points = layers[l].layer->points;
    parallel_for(static_cast<std::int64_t>(points.rows()), [&](Index v) {
      const Vec3 foot = footing.foot.row(v), normal = footing.normal.row(v);
      double own = footing.thickness[v];
      for (std::size_t m = 0; m < layers.size(); ++m) {
        if (m == l || own == 0.0) continue;
        const auto across = hosts[m].nearest_within(foot, kReach);
        if (!across) continue;
        const double room = std::sqrt(across->squared_distance) - gap - 2.0 * kSeat;
        own = std::min(own, allowed(own, thickness[m](layers[l].layer->points.row(v)), room));
      }
      points.row(v) = foot + (kSeat + own) * normal;
    });
    laid.push_back(std::move(points));
  }
  for (std::size_t l = 0; l < layers.size(); ++l) {
    layers[l].layer->points = laid[l];
    update_unfolded(*layers[l].layer);
  }
  return part_layers(layers);
}

}  // namespace coxa::segment
