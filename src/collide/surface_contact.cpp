#include <coxa/collide/surface_contact.h>

#include <coxa/core/error.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>

#include "pair_search.h"

namespace coxa::collide {
namespace {

struct QuadraturePoint {
  Vec3 barycentric;
  double weight;
};

/// Symmetric rules of degree 2 and 4 (Strang and Fix 1973); weights sum to 1.
std::vector<QuadraturePoint> quadrature_points(ContactQuadrature quadrature) {
  std::vector<QuadraturePoint> points;
  const auto add_ring = [&](double small, double weight) {
    for (int k = 0; k < 3; ++k) {
      Vec3 barycentric = Vec3::Constant(small);
      barycentric[k] = 1.0 - 2.0 * small;
      points.push_back({barycentric, weight});
    }
  };
  if (quadrature == ContactQuadrature::three_points) {
    add_ring(1.0 / 6.0, 1.0 / 3.0);
  } else {
    add_ring(0.445948490915965, 0.223381589678011);
    add_ring(0.091576213509771, 0.109951743655322);
  }
  return points;
}

void check(const ContactOptions& options) {
  require(options.stiffness > 0.0, "contact stiffness must be positive (MPa/mm), got ",
          options.stiffness);
  require(options.search_distance > std::abs(options.minimum_gap),
          "contact search_distance must exceed minimum_gap ", options.minimum_gap, " mm, got ",
          options.search_distance);
  require(options.quadrature != ContactQuadrature::cut || options.rule == ContactRule::nodal,
          "contact quadrature cut has other samples at each search: it needs the nodal rule");
  require(options.facing_fully < 1.0, "contact facing_fully must be below 1, got ",
          options.facing_fully);
  require(-1.0 <= options.facing && options.facing < 1.0, "contact facing must be in [-1, 1), got ",
          options.facing);
}

}  // namespace

SurfaceContact::SurfaceContact(ParticleSurface slave, ParticleSurface other,
                               const ContactOptions& options)
    : options_(options), slave_(std::move(slave)), other_(std::move(other)) {
  check(options);
  other_mesh_.triangles = other_->triangles;
  other_mesh_.points = Points::Zero(other_->n_vertices(), 3);
  make_samples();
}

SurfaceContact::SurfaceContact(ParticleSurface slave, TriMesh obstacle,
                               const ContactOptions& options)
    : options_(options), slave_(std::move(slave)), other_mesh_(std::move(obstacle)) {
  check(options);
  if (other_mesh_.empty()) fail(ErrorCode::bad_mesh, "contact obstacle has no triangle");
  tree_.emplace(other_mesh_.points, other_mesh_.triangles);
  other_normals_ = vertex_normals(other_mesh_);
  make_samples();
}

void SurfaceContact::make_samples() {
  if (options_.quadrature == ContactQuadrature::vertices) {
    // each vertex as a corner of its lowest triangle
    std::vector<bool> seen(static_cast<std::size_t>(slave_.n_vertices()), false);
    for (Index t = 0; t < slave_.n_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(slave_.triangles(t, k));
        if (!seen[v]) samples_.push_back({.triangle = t, .barycentric = Vec3::Unit(k)});
        seen[v] = true;
      }
    }
  } else if (options_.quadrature != ContactQuadrature::cut) {
    for (Index t = 0; t < slave_.n_triangles(); ++t) {
      for (const QuadraturePoint& point : quadrature_points(options_.quadrature)) {
        samples_.push_back({.triangle = t, .barycentric = point.barycentric});
      }
    }
  }
  const bool pointwise = options_.rule == ContactRule::pointwise;
  multiplier_.assign(pointwise ? samples_.size() : static_cast<std::size_t>(slave_.n_vertices()),
                     0.0);
  stiffening_.assign(multiplier_.size(), 1.0);
  overlap_.assign(multiplier_.size(), 0.0);
  other_neighbours_ = edge_neighbours(other_mesh_.triangles);
  boundary_vertex_.assign(static_cast<std::size_t>(other_mesh_.n_vertices()), false);
  for (Index t = 0; t < other_mesh_.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (other_neighbours_(t, k) >= 0) continue;
      boundary_vertex_[static_cast<std::size_t>(other_mesh_.triangles(t, k))] = true;
      boundary_vertex_[static_cast<std::size_t>(other_mesh_.triangles(t, (k + 1) % 3))] = true;
    }
  }
}

void SurfaceContact::prepare_other(const VecX& x) {
  if (!other_) return;
  other_mesh_.points = surface_points(*other_, x);
  other_normals_ = vertex_normals(other_mesh_);
  if (tree_) {
    tree_->update_points(other_mesh_.points);
  } else {
    tree_.emplace(other_mesh_.points, other_mesh_.triangles);
  }
}

void SurfaceContact::update_obstacle(const Points& points) {
  COXA_ASSERT(!other_);
  require(points.rows() == other_mesh_.points.rows(), "moved obstacle has ", points.rows(),
          " vertices, expected ", other_mesh_.points.rows());
  other_mesh_.points = points;
  other_normals_ = vertex_normals(other_mesh_);
  tree_->update_points(points);
}

void SurfaceContact::update_areas(const VecX& areas) {
  if (options_.quadrature != ContactQuadrature::vertices) {
    const auto rule = quadrature_points(options_.quadrature);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      samples_[s].area = rule[s % rule.size()].weight * areas[samples_[s].triangle];
    }
    return;
  }
  VecX vertex_area = VecX::Zero(slave_.n_vertices());
  for (Index t = 0; t < slave_.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) vertex_area[slave_.triangles(t, k)] += areas[t] / 3.0;
  }
  for (ContactSample& sample : samples_) {
    int k = 0;
    sample.barycentric.maxCoeff(&k);
    sample.area = vertex_area[slave_.triangles(sample.triangle, k)];
  }
}

void SurfaceContact::update_curvature(const VecX& x) {
  prepare_other(x);
  slave_bulge_ = edge_bulges({surface_points(slave_, x), slave_.triangles});
  other_bulge_ = edge_bulges(other_mesh_);
}

}  // namespace coxa::collide
