#include "feature_curves.h"

#include <coxa/geom/closest_point.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <cmath>
#include <utility>

namespace coxa::meshing {
namespace {

constexpr double kSharp = radians(40.0);  // bend of a feature edge
constexpr double kTurn = radians(45.0);   // a chain that turns by more has a corner there

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Link {
  Index to = 0, edge = 0;
};

class Chains {
 public:
  Chains(const TriMesh& surface, double shortest)
      : surface_(surface), shortest_(shortest), links_(at(surface.n_vertices())) {
    const MeshEdges edges = mesh_edges(surface);
    const Points normals = triangle_normals(surface);
    used_.assign(at(static_cast<Index>(edges.vertices.rows())), 0);
    for (Index e = 0; e < edges.vertices.rows(); ++e) {
      const auto sides = edges.triangles[e];
      if (normals.row(sides.front()).dot(normals.row(sides.back())) > std::cos(kSharp)) continue;
      const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
      links_[at(a)].push_back({b, e});
      links_[at(b)].push_back({a, e});
    }
    corner_.assign(links_.size(), -1);
  }

  FeatureCurves collect() {
    // chains between corners first; what is left is closed
    for (const bool from_corners : {true, false})
      for (Index v = 0; v < surface_.n_vertices(); ++v)
        for (const Link& link : links_[at(v)])
          if (!used_[at(link.edge)] && (!from_corners || is_corner(v))) add_chain(v, link);
    return std::move(found_);
  }

 private:
  Vec3 point(Index v) const { return surface_.points.row(v); }

  bool is_corner(Index v) const {
    const auto& links = links_[at(v)];
    if (links.size() != 2) return !links.empty();
    const Vec3 in = (point(v) - point(links[0].to)).normalized();
    const Vec3 out = (point(links[1].to) - point(v)).normalized();
    return in.dot(out) < std::cos(kTurn);
  }

  void add_chain(Index start, Link link) {
    std::vector<Index> chain{start};
    for (;;) {
      used_[at(link.edge)] = 1;
      chain.push_back(link.to);
      if (is_corner(link.to) || link.to == start) break;
      const auto& links = links_[at(link.to)];
      link = links[links[0].edge == link.edge ? 1 : 0];
    }
    FeatureCurve curve;
    for (const Index v : chain) curve.points.push_back(point(v));
    const bool closed = chain.back() == start && !is_corner(start);
    if (closed) {
      curve.points.pop_back();
    } else {
      curve.first = curve.last = 0;  // not closed, for the length
    }
    if (curve.length() < shortest_) return;
    if (!closed) {
      curve.first = corner_number(start);
      curve.last = corner_number(chain.back());
    }
    found_.curves.push_back(std::move(curve));
  }

  Index corner_number(Index v) {
    if (corner_[at(v)] < 0) {
      corner_[at(v)] = static_cast<Index>(found_.corners.size());
      found_.corners.push_back(point(v));
    }
    return corner_[at(v)];
  }

  const TriMesh& surface_;
  double shortest_;
  std::vector<std::vector<Link>> links_;  // feature edges by vertex
  std::vector<char> used_;                // edges in a chain
  std::vector<Index> corner_;             // number of the corner at a vertex; -1 none
  FeatureCurves found_;
};

}  // namespace

double FeatureCurve::length() const {
  double sum = 0.0;
  for (std::size_t s = 0; s < n_segments(); ++s) sum += (end_of(s) - points[s]).norm();
  return sum;
}

CurvePlace nearest_on(const FeatureCurve& curve, const Vec3& p) {
  CurvePlace best;
  for (std::size_t s = 0; s < curve.n_segments(); ++s) {
    const Vec3 &a = curve.points[s], &b = curve.end_of(s);
    const Vec3 q = a + closest_parameter_on_segment(p, a, b) * (b - a);
    const double distance = (q - p).norm();
    if (distance < best.distance && a != b) best = {q, (b - a).normalized(), distance};
  }
  return best;
}

CurvePlace FeatureCurves::nearest(const Vec3& p) const {
  CurvePlace best;
  for (const FeatureCurve& curve : curves)
    if (const CurvePlace place = nearest_on(curve, p); place.distance < best.distance) best = place;
  return best;
}

FeatureCurves feature_curves(const TriMesh& surface, double shortest) {
  return Chains(surface, shortest).collect();
}

}  // namespace coxa::meshing
