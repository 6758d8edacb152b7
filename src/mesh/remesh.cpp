#include <coxa/mesh/remesh.h>

#include "editable_mesh.h"

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa {
namespace {

class Remesher {
 public:
  Remesher(const TriMesh& mesh, double target_edge)
      : mesh_(mesh),
        surface_(mesh.points, mesh.triangles),
        long_(4.0 / 3.0 * target_edge),
        short_(0.8 * target_edge) {}

  TriMesh run(int iterations) {
    for (int i = 0; i < iterations; ++i) {
      split_long_edges();
      collapse_short_edges();
      even_out_degrees();
      smooth();
    }
    return mesh_.result();
  }

 private:
  double length(Index a, Index b) const { return (mesh_.point(a) - mesh_.point(b)).norm(); }

  // nearest point of the input; stays at p where that lies on the far side of a thin sheet
  Vec3 on_surface(const Vec3& p, const Vec3& normal) const {
    const NearestPoint found = surface_.nearest(p);
    const auto corner = [&](int k) {
      return Vec3(surface_.points().row(surface_.triangles()(found.triangle, k)));
    };
    const Vec3 there = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    return there.dot(normal) < 0.0 ? p : found.point;
  }

  void split_long_edges() {
    struct LongEdge {
      double length;
      Index a, b;
    };
    std::vector<LongEdge> edges;
    do {
      edges.clear();
      for (const auto& [a, b] : mesh_.edges())
        if (length(a, b) > long_) edges.push_back({length(a, b), a, b});
      // longest first: halves of long edges then meet their neighbours' halves
      std::stable_sort(edges.begin(), edges.end(),
                       [](const LongEdge& e, const LongEdge& f) { return e.length > f.length; });
      for (const LongEdge& edge : edges) split(edge.a, edge.b);
    } while (!edges.empty());
  }

  void split(Index a, Index b) {
    const Vec3 middle = 0.5 * (mesh_.point(a) + mesh_.point(b));
    const Vec3 normal = mesh_.vertex_normal(a) + mesh_.vertex_normal(b);
    const Index m = mesh_.split(a, b, middle);
    const Vec3 p = on_surface(middle, normal);
    if (mesh_.can_move(m, p)) mesh_.move(m, p);
  }

  void collapse_short_edges() {
    for (const auto& [a, b] : mesh_.edges()) {
      if (!mesh_.alive(a) || !mesh_.alive(b) || length(a, b) >= short_) continue;
      const auto ring = mesh_.neighbours(a);
      if (!std::binary_search(ring.begin(), ring.end(), b)) continue;
      const Vec3 middle = 0.5 * (mesh_.point(a) + mesh_.point(b));
      const Vec3 p = on_surface(middle, mesh_.vertex_normal(a) + mesh_.vertex_normal(b));
      if (!makes_long_edge(a, b, p) && mesh_.can_collapse(a, b, p)) mesh_.collapse(a, b, p);
    }
  }

  bool makes_long_edge(Index a, Index b, const Vec3& p) const {
    for (Index end : {a, b})
      for (Index v : mesh_.neighbours(end))
        if (v != a && v != b && (mesh_.point(v) - p).norm() > long_) return true;
    return false;
  }

  void even_out_degrees() {
    const auto excess = [&](Index v, Index change) {
      return std::abs(mesh_.degree(v) + change - 6);
    };
    for (const auto& [a, b] : mesh_.edges()) {
      const auto ring = mesh_.neighbours(a);
      if (!std::binary_search(ring.begin(), ring.end(), b)) continue;  // flipped away meanwhile
      const auto [c, d] = mesh_.opposite(a, b);
      const auto now = excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0);
      const auto then = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
      if (then < now && mesh_.can_flip(a, b) && stays_near(a, b, c, d)) mesh_.flip(a, b);
    }
  }

  // a flip across a ridge would cut it off: the new edge's middle must stay as near to the old one
  // as to the surface the sizes allow
  bool stays_near(Index a, Index b, Index c, Index d) const {
    const Vec3 old_middle = 0.5 * (mesh_.point(a) + mesh_.point(b)),
               new_middle = 0.5 * (mesh_.point(c) + mesh_.point(d));
    const Vec3 normal = (mesh_.vertex_normal(a) + mesh_.vertex_normal(b)).normalized();
    return std::abs((new_middle - old_middle).dot(normal)) < 0.2 * short_;
  }

  // towards the area-weighted mean of the neighbours' places, along the surface
  void smooth() {
    std::vector<Vec3> targets(static_cast<std::size_t>(mesh_.n_vertices()));
    for (Index v = 0; v < mesh_.n_vertices(); ++v)
      if (mesh_.alive(v)) targets[static_cast<std::size_t>(v)] = smoothed(v);
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      if (!mesh_.alive(v)) continue;
      const Vec3 p = on_surface(targets[static_cast<std::size_t>(v)], mesh_.vertex_normal(v));
      if (mesh_.can_move(v, p)) mesh_.move(v, p);
    }
  }

  Vec3 smoothed(Index v) const {
    Vec3 sum = Vec3::Zero();
    double weights = 0.0;
    for (Index t : mesh_.around(v)) {
      const double weight = mesh_.area_vector(t).norm();
      Vec3 centroid = Vec3::Zero();
      for (Index corner : mesh_.triangle(t)) centroid += mesh_.point(corner) / 3.0;
      sum += weight * centroid;
      weights += weight;
    }
    if (!(weights > 0.0)) return mesh_.point(v);
    const Vec3 normal = mesh_.vertex_normal(v), step = sum / weights - mesh_.point(v);
    return mesh_.point(v) + step - step.dot(normal) * normal;
  }

  EditableMesh mesh_;
  TriangleTree surface_;
  double long_, short_;
};

}  // namespace

TriMesh remesh(const TriMesh& mesh, const RemeshOptions& options) {
  require(options.target_edge > 0.0, "remesh: target_edge must be positive, got ",
          options.target_edge, " mm");
  require(options.iterations >= 1, "remesh: iterations must be at least 1, got ",
          options.iterations);
  require_closed_manifold(mesh, "remesh");
  const double expected =
      2.0 / std::sqrt(3.0) * area(mesh) / (0.5 * options.target_edge * options.target_edge);
  require(expected < 5e7, "remesh: target_edge ", options.target_edge, " mm would give about ",
          expected, " triangles");
  return Remesher(mesh, options.target_edge).run(options.iterations);
}

double edge_length_for(const TriMesh& mesh, Index n_triangles) {
  require(n_triangles > 0, "edge_length_for: n_triangles must be positive, got ", n_triangles);
  return std::sqrt(4.0 / std::sqrt(3.0) * area(mesh) / n_triangles);
}

}  // namespace coxa
