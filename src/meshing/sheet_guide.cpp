#include "sheet_guide.h"

#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace coxa::meshing {
namespace {

using medial::BorderCurve;
using medial::FacePair;

constexpr double kLeastRounding = 0.05;        // mm
constexpr double kBluntAngle = radians(17.0);  // wedges of this angle need no rounding

// the rim, moved inwards just enough to make the elements beside a knife edge blunt
BorderCurve moved_inwards(const FacePair& faces, double limit) {
  constexpr double kReach = 1.0;  // mm of movement for an edge of no angle at all, before the limit
  BorderCurve curve;
  for (const auto& loop : faces.rim().loops) {
    auto& made = curve.loops.emplace_back();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      // a point midway too: long edges bend with their neighbours
      const Vec3 middle = 0.5 * (loop[i] + loop[(i + 1) % loop.size()]);
      for (const Vec3& p : {loop[i], middle}) {
        const medial::RimWedge wedge = faces.rim_wedge(p);
        const double wanted = kReach * (1.0 - wedge.angle / kBluntAngle);
        made.push_back(p +
                       std::clamp(wanted, std::min(kLeastRounding, limit), limit) * wedge.inward);
      }
    }
  }
  return curve;
}

// edges of a face bent far more than its usual edges, each as a loop of two points
BorderCurve creases_of(const TriMesh& face) {
  constexpr double kLeastBend = radians(15.0);
  constexpr double kUnusual = 3.0;  // times the median bend
  const MeshEdges edges = mesh_edges(face);
  const Points normals = triangle_normals(face);
  std::vector<double> bends;
  for (Index e = 0; e < edges.triangles.size(); ++e) {
    const auto pair = edges.triangles[e];
    const double cosine = pair.size() == 2 ? normals.row(pair[0]).dot(normals.row(pair[1])) : 1.0;
    bends.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  std::vector<double> sorted = bends;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double limit = std::max(kLeastBend, kUnusual * sorted[sorted.size() / 2]);
  BorderCurve curve;
  for (std::size_t e = 0; e < bends.size(); ++e) {
    if (bends[e] <= limit) continue;
    const auto row = edges.vertices.row(static_cast<Eigen::Index>(e));
    curve.loops.push_back({face.points.row(row[0]), face.points.row(row[1])});
  }
  return curve;
}

Vec3 triangle_normal(const TriangleTree& tree, Index t) {
  const Vec3 a = tree.points().row(tree.triangles()(t, 0)),
             b = tree.points().row(tree.triangles()(t, 1)),
             c = tree.points().row(tree.triangles()(t, 2));
  return (b - a).cross(c - a).normalized();
}

TriMesh joined(const TriMesh& a, const TriMesh& b) {
  TriMesh both;
  both.points.resize(a.points.rows() + b.points.rows(), 3);
  both.points << a.points, b.points;
  both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  both.triangles << a.triangles, b.triangles.array() + a.n_vertices();
  return both;
}

}  // namespace

SheetGuide::SheetGuide(const TriMesh& surface, const medial::SurfaceSides& sides,
                       const FacePair& faces, double rounding)
    : faces_(faces),
      rim_edge_(moved_inwards(faces, rounding)),
      first_creases_(creases_of(faces.first_face())),
      second_creases_(creases_of(faces.second_face())) {
  const TriMesh band =
      joined(medial::face_of(surface, sides, medial::SideLabel::rim), faces.cut_wall());
  if (!band.empty()) band_.emplace(band.points, band.triangles);
  for (const auto& loop : rim_edge_.loops) {
    for (const Vec3& p : loop) {
      largest_rounding_ = std::max(largest_rounding_, (p - faces.on_rim(p)).norm());
    }
  }
}

Vec3 SheetGuide::place(NodeKind kind, const Vec3& p) const {
  switch (kind) {
    case NodeKind::first_face:
      return faces_.first_tree().nearest(p).point;
    case NodeKind::second_face:
      return faces_.second_tree().nearest(p).point;
    case NodeKind::rim_band:
      return band_ ? band_->nearest(p).point : p;
    case NodeKind::rim_edge:
      return rim_edge_.nearest(p).point;
    case NodeKind::first_border:
      return faces_.first_border().nearest(p).point;
    case NodeKind::second_border:
      return faces_.second_border().nearest(p).point;
    case NodeKind::first_crease:
      return first_creases_.nearest(p).point;
    case NodeKind::second_crease:
      return second_creases_.nearest(p).point;
    case NodeKind::inside:
    case NodeKind::first_corner:
    case NodeKind::second_corner:
    case NodeKind::rim_corner:
      break;
  }
  return p;
}

std::optional<Vec3> SheetGuide::nearest_crease(NodeKind face, const Vec3& p) const {
  const BorderCurve& creases = face == NodeKind::first_face ? first_creases_ : second_creases_;
  if (creases.loops.empty()) return std::nullopt;
  return creases.nearest(p).point;
}

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> SheetGuide::directions(NodeKind kind,
                                                                         const Vec3& p) const {
  switch (kind) {
    case NodeKind::inside:
      return Mat3::Identity();
    case NodeKind::first_face:
      return tangents(
          triangle_normal(faces_.first_tree(), faces_.first_tree().nearest(p).triangle));
    case NodeKind::second_face:
      return tangents(
          triangle_normal(faces_.second_tree(), faces_.second_tree().nearest(p).triangle));
    case NodeKind::rim_band:
      if (!band_) break;
      return tangents(triangle_normal(*band_, band_->nearest(p).triangle));
    case NodeKind::rim_edge:
      return rim_edge_.nearest(p).tangent;
    case NodeKind::first_border:
      return faces_.first_border().nearest(p).tangent;
    case NodeKind::second_border:
      return faces_.second_border().nearest(p).tangent;
    case NodeKind::first_crease:
      return first_creases_.nearest(p).tangent;
    case NodeKind::second_crease:
      return second_creases_.nearest(p).tangent;
    case NodeKind::first_corner:
    case NodeKind::second_corner:
    case NodeKind::rim_corner:
      break;
  }
  return Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>(3, 0);
}

}  // namespace coxa::meshing
