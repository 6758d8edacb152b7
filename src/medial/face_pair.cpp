#include <coxa/medial/face_pair.h>

#include <coxa/geom/closest_point.h>
#include <coxa/mesh/topology.h>

#include <algorithm>
#include <cmath>

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

namespace {

struct Place {
  std::size_t loop = 0, segment = 0;
  Vec3 point = Vec3::Zero();
  double squared_distance = kInfinity;
};

Place find_place(const std::vector<std::vector<Vec3>>& loops, const Vec3& p) {
  Place best;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const auto& loop = loops[l];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
      const Vec3 q = a + closest_parameter_on_segment(p, a, b) * (b - a);
      const double distance = (q - p).squaredNorm();
      if (distance < best.squared_distance && a != b) best = {l, i, q, distance};
    }
  }
  return best;
}

// walks from a place on segment `segment` for `reach` mm; step 1 forward, n - 1 backward
Vec3 walk(const std::vector<Vec3>& loop, const Place& from, double reach, bool forward) {
  const std::size_t n = loop.size();
  Vec3 p = from.point;
  std::size_t next = forward ? (from.segment + 1) % n : from.segment;
  for (std::size_t k = 0; k < n; ++k) {
    const double length = (loop[next] - p).norm();
    if (length >= reach) return p + reach / length * (loop[next] - p);
    reach -= length;
    p = loop[next];
    next = forward ? (next + 1) % n : (next + n - 1) % n;
  }
  return p;
}

}  // namespace

BorderCurve::Nearest BorderCurve::nearest(const Vec3& p) const {
  const Place place = find_place(loops, p);
  if (place.squared_distance == kInfinity) return {p, Vec3::UnitX()};
  const auto& loop = loops[place.loop];
  return {place.point,
          (loop[(place.segment + 1) % loop.size()] - loop[place.segment]).normalized()};
}

std::pair<Vec3, Vec3> BorderCurve::around(const Vec3& p, double reach) const {
  const Place place = find_place(loops, p);
  if (place.squared_distance == kInfinity) return {p, p};
  return {walk(loops[place.loop], place, reach, false),
          walk(loops[place.loop], place, reach, true)};
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

InwardField inward_field(const TriMesh& face) {
  InwardField field;
  const MeshEdges edges = mesh_edges(face);
  for (Index t = 0; t < face.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (edges.triangles[edges.of_triangle(t, k)].size() != 1) continue;
      const Vec3 a = face.points.row(face.triangles(t, k));
      const Vec3 b = face.points.row(face.triangles(t, (k + 1) % 3));
      const Vec3 c = face.points.row(face.triangles(t, (k + 2) % 3));
      const Vec3 along = (b - a).normalized();
      const Vec3 inward = (c - a) - along * along.dot(c - a);
      if (inward.norm() <= 0.0) continue;
      field.places.push_back(0.5 * (a + b));
      field.directions.push_back(inward.normalized());
    }
  }
  return field;
}

Vec3 InwardField::mean(const Vec3& p, double reach) const {
  constexpr double kNegligible = 20.0;  // beyond this exponent an edge has no weight
  // the nearest edge counts fully however far it is
  double nearest = kInfinity;
  for (const Vec3& q : places) nearest = std::min(nearest, (q - p).squaredNorm());
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double d = ((places[i] - p).squaredNorm() - nearest) / (reach * reach);
    if (d < kNegligible) sum += std::exp(-d) * directions[i];
  }
  return sum;
}

FacePair::FacePair(const TriMesh& surface, const SurfaceSides& sides)
    : first_face_(face_of(surface, sides, SideLabel::first)),
      second_face_(face_of(surface, sides, SideLabel::second)),
      first_(first_face_.points, first_face_.triangles),
      second_(second_face_.points, second_face_.triangles),
      first_border_(border_of(first_face_)),
      second_border_(border_of(second_face_)),
      rim_(halfway(first_border_, second_border_)),
      first_inward_(inward_field(first_face_)),
      second_inward_(inward_field(second_face_)) {}

RimWedge FacePair::rim_wedge(const Vec3& p) const {
  constexpr double kReach = 1.0;  // mm
  const Vec3 a = first_inward_.mean(p, kReach), b = second_inward_.mean(p, kReach);
  if (a.norm() <= 0.0 || b.norm() <= 0.0) return {};
  RimWedge wedge;
  wedge.angle = std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
  const Vec3 middle = a.normalized() + b.normalized();
  if (middle.norm() > 0.0) wedge.inward = middle.normalized();
  return wedge;
}

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
