#include <coxa/medial/face_pair.h>

#include <coxa/geom/closest_point.h>
#include <coxa/mesh/topology.h>

namespace coxa::medial {
namespace {

// feet closer than this have no direction between them, mm
constexpr double kTouching = 1e-9;

BorderCurve halfway(const BorderCurve& from, const BorderCurve& to) {
  BorderCurve curve;
  for (const auto& loop : from.loops) {
    auto& made = curve.loops.emplace_back();
    for (const Vec3& p : loop) made.push_back(0.5 * (p + to.nearest(p).point));
  }
  return curve;
}

}  // namespace

BorderCurve::Nearest BorderCurve::nearest(const Vec3& p) const {
  double best = kInfinity;
  Nearest found{p, Vec3::UnitX()};
  for (const auto& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
      const Vec3 q = a + closest_parameter_on_segment(p, a, b) * (b - a);
      const double distance = (q - p).squaredNorm();
      if (distance < best && a != b) {
        best = distance;
        found = {q, (b - a).normalized()};
      }
    }
  }
  return found;
}

TriMesh face_of(const TriMesh& surface, const SurfaceSides& sides, SideLabel label) {
  std::vector<Index> triangles;
  for (Index t = 0; t < surface.n_triangles(); ++t) {
    if (sides.labels[static_cast<std::size_t>(t)] == label) triangles.push_back(t);
  }
  return sub_mesh(surface, triangles).mesh;
}

BorderCurve border_of(const TriMesh& face) {
  BorderCurve curve;
  for (const auto& loop : boundary_loops(face)) {
    auto& made = curve.loops.emplace_back();
    for (const Index v : loop) made.emplace_back(face.points.row(v));
  }
  return curve;
}

FacePair::FacePair(const TriMesh& surface, const SurfaceSides& sides)
    : first_face_(face_of(surface, sides, SideLabel::first)),
      second_face_(face_of(surface, sides, SideLabel::second)),
      first_(first_face_.points, first_face_.triangles),
      second_(second_face_.points, second_face_.triangles),
      first_border_(border_of(first_face_)),
      second_border_(border_of(second_face_)),
      rim_(halfway(first_border_, second_border_)) {}

BallFeet FacePair::feet(const Vec3& p) const {
  return {first_.nearest(p).point, second_.nearest(p).point};
}

Vec3 FacePair::centred(const Vec3& p) const {
  const BallFeet f = feet(p);
  const Vec3 middle = 0.5 * (f.first + f.second);
  const Vec3 across = f.second - f.first;
  const double length = across.norm();
  if (length < kTouching) return middle;
  const Vec3 n = across / length;
  return p + n * n.dot(middle - p);
}

BallFeet FacePair::rim_feet(const Vec3& p) const {
  return {first_border_.nearest(p).point, second_border_.nearest(p).point};
}

}  // namespace coxa::medial
