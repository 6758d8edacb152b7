#include <coxa/medial/face_pair.h>

#include <coxa/geom/closest_point.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::medial {
namespace {

// feet closer than this have no direction between them, mm
constexpr double kTouching = 1e-9;

constexpr double kWedgeReach = 1.0;  // mm: over which the wedge at the rim is seen

// entries on the old rim go where the new one has left it
void keep_near(InwardField& field, const BorderCurve& rim) {
  constexpr double kNear = 0.2;  // mm
  InwardField kept;
  for (std::size_t i = 0; i < field.places.size(); ++i) {
    if ((rim.nearest(field.places[i]).point - field.places[i]).norm() > kNear) continue;
    kept.places.push_back(field.places[i]);
    kept.directions.push_back(field.directions[i]);
  }
  field = std::move(kept);
}

// middles of the cut border edges and the directions from there into the sheet
std::vector<std::pair<Vec3, Vec3>> inward_at(const TriMesh& sheet, const std::vector<char>& cut) {
  std::vector<std::pair<Vec3, Vec3>> found;
  const MeshEdges edges = mesh_edges(sheet);
  for (Index t = 0; t < sheet.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index i = sheet.triangles(t, k), j = sheet.triangles(t, (k + 1) % 3);
      const bool is_cut = cut[static_cast<std::size_t>(i)] || cut[static_cast<std::size_t>(j)];
      if (!is_cut || edges.triangles[edges.of_triangle(t, k)].size() != 1) continue;
      const Vec3 a = sheet.points.row(i), b = sheet.points.row(j),
                 c = sheet.points.row(sheet.triangles(t, (k + 2) % 3));
      const Vec3 along = (b - a).normalized();
      const Vec3 inward = (c - a) - along * along.dot(c - a);
      if (inward.norm() > 0.0) found.emplace_back(0.5 * (a + b), inward.normalized());
    }
  }
  return found;
}

TriMesh wall_of(const std::vector<std::array<Vec3, 4>>& quads) {
  TriMesh wall;
  const auto n = static_cast<Eigen::Index>(quads.size());
  wall.points.resize(4 * n, 3);
  wall.triangles.resize(2 * n, 3);
  for (Eigen::Index q = 0; q < n; ++q) {
    for (std::size_t k = 0; k < 4; ++k)
      wall.points.row(4 * q + static_cast<Eigen::Index>(k)) = quads[static_cast<std::size_t>(q)][k];
    const Index v = static_cast<Index>(4 * q);
    wall.triangles.row(2 * q) << v, v + 1, v + 2;
    wall.triangles.row(2 * q + 1) << v, v + 2, v + 3;
  }
  return wall;
}

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
      second_inward_(inward_field(second_face_)),
      start_(first_face_) {
  start_.triangles.col(1).swap(start_.triangles.col(2));
}

void FacePair::update_rim(const TrimmedSheet& trimmed) {
  const TriMesh& sheet = trimmed.sheet;
  const auto is_cut = [&](Index v) { return trimmed.cut[static_cast<std::size_t>(v)] != 0; };
  BorderCurve first, second, middle;
  std::vector<std::array<Vec3, 4>> walls;
  for (const auto& loop : boundary_loops(sheet)) {
    for (BorderCurve* curve : {&first, &second, &middle}) curve->loops.emplace_back();
    for (const Index v : loop) {
      const Vec3 p = sheet.points.row(v);
      const BallFeet f = is_cut(v) ? feet(p) : rim_feet(p);
      first.loops.back().push_back(f.first);
      second.loops.back().push_back(f.second);
      middle.loops.back().push_back(0.5 * (f.first + f.second));
    }
    const auto &a = first.loops.back(), &b = second.loops.back();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t k = (i + 1) % loop.size();
      if (is_cut(loop[i]) || is_cut(loop[k])) walls.push_back({a[i], a[k], b[k], b[i]});
    }
  }
  keep_near(first_inward_, middle);
  keep_near(second_inward_, middle);
  for (const auto& [p, inward] : inward_at(sheet, trimmed.cut)) {
    const Vec3 q = p + kWedgeReach * inward;
    const BallFeet f = feet(q);
    first_inward_.places.push_back(p);
    first_inward_.directions.push_back((f.first - p).normalized());
    second_inward_.places.push_back(p);
    second_inward_.directions.push_back((f.second - p).normalized());
  }
  cut_wall_ = wall_of(walls);
  first_border_ = std::move(first);
  second_border_ = std::move(second);
  rim_ = std::move(middle);
  start_ = sheet;
}

RimWedge FacePair::rim_wedge(const Vec3& p) const {
  const Vec3 a = first_inward_.mean(p, kWedgeReach), b = second_inward_.mean(p, kWedgeReach);
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

Vec3 FacePair::up(const Vec3& p) const {
  const auto normal = [&p](const TriangleTree& tree) -> Vec3 {
    const Index t = tree.nearest(p).triangle;
    const Vec3 a = tree.points().row(tree.triangles()(t, 0)),
               b = tree.points().row(tree.triangles()(t, 1)),
               c = tree.points().row(tree.triangles()(t, 2));
    return (b - a).cross(c - a).normalized();
  };
  const Vec3 sum = normal(second_) - normal(first_);
  return sum.norm() > 1e-6 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

BallFeet FacePair::rim_feet(const Vec3& p) const {
  return {first_border_.nearest(p).point, second_border_.nearest(p).point};
}

}  // namespace coxa::medial
