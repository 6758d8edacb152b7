#include "slide_guide.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace coxa::meshing {
namespace {

using medial::BorderCurve;
using medial::FacePair;

// unit vectors in the face, at right angles to its border edges and pointing into it, with the
// place
struct InwardField {
  std::vector<Vec3> places, directions;

  explicit InwardField(const TriMesh& face) {
    std::map<std::pair<Index, Index>, int> uses;
    for (Index t = 0; t < face.n_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Index a = face.triangles(t, k), b = face.triangles(t, (k + 1) % 3);
        ++uses[{std::min(a, b), std::max(a, b)}];
      }
    }
    for (Index t = 0; t < face.n_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Index ia = face.triangles(t, k), ib = face.triangles(t, (k + 1) % 3);
        if (uses[{std::min(ia, ib), std::max(ia, ib)}] != 1) continue;
        const Vec3 a = face.points.row(ia), b = face.points.row(ib),
                   c = face.points.row(face.triangles(t, (k + 2) % 3));
        const Vec3 along = (b - a).normalized();
        const Vec3 inward = (c - a) - along * along.dot(c - a);
        if (inward.norm() <= 0.0) continue;
        places.push_back(0.5 * (a + b));
        directions.push_back(inward.normalized());
      }
    }
  }

  // mean direction of the border edges near p, nearer ones counting more
  Vec3 mean(const Vec3& p, double reach) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double d = (places[i] - p).squaredNorm() / (reach * reach);
      if (d < 20.0) sum += std::exp(-d) * directions[i];
    }
    return sum;
  }
};

BorderCurve moved_inwards(const FacePair& faces, double rounding) {
  constexpr double kReach = 1.5;  // mm: the inward direction is a mean over this distance
  const InwardField first(faces.first_face()), second(faces.second_face());
  BorderCurve curve;
  for (const auto& loop : faces.rim().loops) {
    auto& made = curve.loops.emplace_back();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      // a point midway too: long edges bend with their neighbours
      const Vec3 middle = 0.5 * (loop[i] + loop[(i + 1) % loop.size()]);
      for (const Vec3& p : {loop[i], middle}) {
        const Vec3 inward = first.mean(p, kReach) + second.mean(p, kReach);
        made.push_back(inward.norm() > 0.0 ? Vec3(p + rounding * inward.normalized()) : p);
      }
    }
  }
  return curve;
}

Eigen::Matrix<double, 3, 2> tangents(const Vec3& n) {
  Eigen::Index k = 0;
  n.cwiseAbs().minCoeff(&k);
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = n.cross(Vec3::Unit(k)).normalized();
  result.col(1) = n.cross(result.col(0));
  return result;
}

Vec3 triangle_normal(const TriangleTree& tree, Index t) {
  const Vec3 a = tree.points().row(tree.triangles()(t, 0)),
             b = tree.points().row(tree.triangles()(t, 1)),
             c = tree.points().row(tree.triangles()(t, 2));
  return (b - a).cross(c - a).normalized();
}

}  // namespace

SlideGuide::SlideGuide(const TriMesh& surface, const medial::SurfaceSides& sides,
                       const FacePair& faces, double rounding)
    : faces_(faces), rim_edge_(moved_inwards(faces, rounding)) {
  TriMesh band = medial::face_of(surface, sides, medial::SideLabel::rim);
  if (!band.empty()) band_.emplace(band.points, band.triangles);
  for (const auto& loop : rim_edge_.loops) {
    for (const Vec3& p : loop) {
      largest_rounding_ = std::max(largest_rounding_, (p - faces.on_rim(p)).norm());
    }
  }
}

Vec3 SlideGuide::place(NodeKind kind, const Vec3& p) const {
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
    case NodeKind::inside:
    case NodeKind::fixed:
      break;
  }
  return p;
}

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> SlideGuide::directions(NodeKind kind,
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
    case NodeKind::fixed:
      break;
  }
  return Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>(3, 0);
}

}  // namespace coxa::meshing
