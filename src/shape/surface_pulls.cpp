#include "surface_pulls.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/closest_point.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa::shape {
namespace {

// a long pull must point across the surface: one along it comes from an end that has no counterpart
constexpr double kShortPull = 3.0;         // mm
constexpr double kAcrossTheSurface = 0.6;  // cosine
// pull of a border on a border, against 1 for a vertex on a surface
constexpr double kBorderWeight = 2.0;

bool plausible(const Vec3& pull, const Vec3& normal) {
  const double length = pull.norm();
  return length < kShortPull || std::abs(pull.dot(normal)) > kAcrossTheSurface * length;
}

double trust_of(const TrustedSurface& surface, Index v) {
  return surface.trust.size() == 0 ? 1.0 : surface.trust[v];
}

double trust_at(const TrustedSurface& surface, Index t) {
  double least = 1.0;
  for (int c = 0; c < 3; ++c)
    least = std::min(least, trust_of(surface, surface.mesh.triangles(t, c)));
  return least;
}

/// True where the nearest point lies on a border: the surface has nothing to say about beyond.
bool on_border(const NearestPoint& hit, const Triangles& triangles,
               const std::vector<bool>& is_border) {
  for (int c = 0; c < 3; ++c) {
    const Index v = triangles(hit.triangle, c);
    if (hit.barycentric[c] > 0.0 && !is_border[static_cast<std::size_t>(v)]) return false;
  }
  return true;
}

std::vector<bool> border_flags(const TriMesh& mesh,
                               const std::vector<std::pair<Index, Index>>& border) {
  std::vector<bool> flags(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (const auto& [a, b] : border) flags[static_cast<std::size_t>(a)] = true;
  return flags;
}

std::optional<Vec3> nearest_on_border(const Vec3& p, const TriMesh& mesh,
                                      const std::vector<std::pair<Index, Index>>& border,
                                      double reach) {
  std::optional<Vec3> best;
  double least = reach * reach;
  for (const auto& [i, j] : border) {
    const Vec3 a = mesh.points.row(i), b = mesh.points.row(j);
    const Vec3 q = a + closest_parameter_on_segment(p, a, b) * (b - a);
    if ((q - p).squaredNorm() < least) {
      least = (q - p).squaredNorm();
      best = q;
    }
  }
  return best;
}

}  // namespace

std::vector<std::pair<Index, Index>> border_edges(const TriMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<std::pair<Index, Index>> border;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    for (int c = 0; c < 3; ++c) {
      if (edges.triangles[edges.of_triangle(t, c)].size() == 1)
        border.emplace_back(mesh.triangles(t, c), mesh.triangles(t, (c + 1) % 3));
    }
  }
  return border;
}

PullTarget::PullTarget(const TrustedSurface& surface)
    : surface_(&surface),
      tree_(surface.mesh.points, surface.mesh.triangles),
      vertex_normals_(vertex_normals(surface.mesh)),
      triangle_normals_(triangle_normals(surface.mesh)),
      border_(border_edges(surface.mesh)) {}

void PullTarget::add_forward(const TrustedSurface& moving, const RegistrationOptions& options,
                             Pulls& pulls) const {
  const Points normals = vertex_normals(moving.mesh);
  const std::vector<bool> edge_of_target = border_flags(surface_->mesh, border_);
  parallel_for(moving.mesh.n_vertices(), [&](Index v) {
    const Vec3 p = moving.mesh.points.row(v), normal = normals.row(v);
    const auto hit = tree_.nearest_within(p, options.largest_distance);
    if (!hit || triangle_normals_.row(hit->triangle).dot(normal) < options.normal_limit) return;
    if (!border_.empty() && on_border(*hit, surface_->mesh.triangles, edge_of_target)) return;
    const Vec3 pull = hit->point - p;
    const double weight = trust_of(moving, v) * trust_at(*surface_, hit->triangle);
    if (weight <= 0.0 || !plausible(pull, normal)) return;
    pulls.displacement.row(v) += weight * pull;
    pulls.weight[v] += weight;
  });
}

void PullTarget::add_backward(const TrustedSurface& moving, const RegistrationOptions& options,
                              Pulls& pulls) const {
  const TriangleTree tree(moving.mesh.points, moving.mesh.triangles);
  const Points normals = triangle_normals(moving.mesh);
  const std::vector<bool> edge_of_moving = border_flags(moving.mesh, border_edges(moving.mesh));
  const Index n = surface_->mesh.n_vertices();
  std::vector<std::optional<NearestPoint>> hits(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index v) {
    const Vec3 p = surface_->mesh.points.row(v), normal = vertex_normals_.row(v);
    const auto hit = tree.nearest_within(p, options.largest_distance);
    if (!hit || normals.row(hit->triangle).dot(normal) < options.normal_limit) return;
    if (on_border(*hit, moving.mesh.triangles, edge_of_moving)) return;
    const bool trusted = trust_of(*surface_, v) > 0.0 && trust_at(moving, hit->triangle) > 0.0;
    if (trusted && plausible(p - hit->point, normal)) hits[static_cast<std::size_t>(v)] = hit;
  });
  // a fine target must not outweigh the moving surface's own pulls
  const double share = std::min(1.0, static_cast<double>(moving.mesh.n_vertices()) / n);
  for (Index v = 0; v < n; ++v) {
    const auto& hit = hits[static_cast<std::size_t>(v)];
    if (!hit) continue;
    const Vec3 pull = Vec3(surface_->mesh.points.row(v)) - hit->point;
    for (int c = 0; c < 3; ++c) {
      const Index corner = moving.mesh.triangles(hit->triangle, c);
      const double weight = share * hit->barycentric[c];
      pulls.displacement.row(corner) += weight * pull;
      pulls.weight[corner] += weight;
    }
  }
}

void PullTarget::add_border(const TrustedSurface& moving, const RegistrationOptions& options,
                            Pulls& pulls) const {
  const auto border = border_edges(moving.mesh);
  if (border_.empty() || border.empty()) return;
  const double reach = options.largest_distance;
  for (const auto& [v, next] : border) {
    const Vec3 p = moving.mesh.points.row(v);
    const auto q = nearest_on_border(p, surface_->mesh, border_, reach);
    if (!q) continue;
    pulls.displacement.row(v) += kBorderWeight * (*q - p);
    pulls.weight[v] += kBorderWeight;
  }
}

Pulls PullTarget::pulls_on(const TrustedSurface& moving, const RegistrationOptions& options) const {
  const Index n = moving.mesh.n_vertices();
  Pulls pulls{Points::Zero(n, 3), VecX::Zero(n)};
  add_forward(moving, options, pulls);
  add_backward(moving, options, pulls);
  add_border(moving, options, pulls);
  for (Index v = 0; v < n; ++v) {
    if (pulls.weight[v] > 0.0) pulls.displacement.row(v) /= pulls.weight[v];
  }
  return pulls;
}

Pulls PullTarget::forward_pulls(const TrustedSurface& moving,
                                const RegistrationOptions& options) const {
  const Index n = moving.mesh.n_vertices();
  Pulls pulls{Points::Zero(n, 3), VecX::Zero(n)};
  add_forward(moving, options, pulls);
  add_border(moving, options, pulls);
  for (Index v = 0; v < n; ++v) {
    if (pulls.weight[v] > 0.0) pulls.displacement.row(v) /= pulls.weight[v];
  }
  return pulls;
}

}  // namespace coxa::shape
