#include <coxa/shape/labrum.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/triangle_list.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "keep_clear.h"

namespace coxa::shape {
namespace {

// Height by clock, mm (6 is the notch). Won et al. 2003: 7.4 and 7.0 at the two anterior of seven
// places, 4.0 to 6.8 at the others; Tan et al. 2001: 5.3 on average, wider anteriorly and
// superiorly.
constexpr std::array<double, 9> kPlaces{0.0, 1.5, 3.0, 4.5, 6.0, 7.5, 9.0, 10.5, 12.0};
constexpr std::array<double, 9> kHeights{6.8, 7.0, 7.4, 5.6, 4.8, 4.0, 5.0, 5.6, 6.8};
// mm: of the base, inside and outside of the edge. Together 5, twice the mean thickness of 2 to 3
// that is described (Lewis and Sahrmann 2006), as the section is a triangle.
constexpr double kInside = 1.5, kOutside = 3.5;
// share of the section that is left where it meets the transverse ligament, and mm over which it
// gets there
constexpr double kEndShare = 0.6, kEndLength = 8.0;
// mm beside the cartilage's border, where bone is bare
constexpr double kBesideCartilage = 0.3;
// mm: what is nearer to or farther from the centre is not the head
constexpr double kHeadWithin = 4.0;
// share of the outer side's length by which it bulges
constexpr double kBulge = 0.06;

// mm between the labrum's end and the transverse ligament, so that they stay two surfaces
constexpr double kEndGap = 0.3;

// points of a section: base from inside to outside, tip, and between them
constexpr int kBase = 7, kSide = 4, kSection = kBase + 2 * kSide + 1;
constexpr int kTip = kBase + kSide;
using Section = std::array<Vec3, kSection>;

/// Distance from the socket's centre to the outside of the head, by direction.
class HeadRadius {
 public:
  HeadRadius(const SocketRim& rim, const std::vector<TriMesh>& head) : rim_(rim) {
    for (const TriMesh& mesh : head) trees_.emplace_back(mesh.points, mesh.triangles);
  }
  double operator()(double hour, double height) const {
    const Vec3 d = rim_.direction(hour, height);
    const Vec3 from = rim_.clock.centre + (rim_.radius + kHeadWithin) * d;
    double radius = rim_.radius;
    bool met = false;
    for (const TriangleTree& tree : trees_) {
      const auto hit = tree.first_hit(from, -d, 2.0 * kHeadWithin);
      if (!hit) continue;
      const double at = rim_.radius + kHeadWithin - hit->distance;
      radius = met ? std::max(radius, at) : at;
      met = true;
    }
    return radius;
  }
  const std::vector<TriangleTree>& parts() const { return trees_; }

 private:
  const SocketRim& rim_;
  std::vector<TriangleTree> trees_;
};

struct Ring {
  const SocketRim& rim;
  const TriangleTree& bone;
  const HeadRadius& head;
  const LabrumOptions& options;

  /// A point on the bone near p, lifted off by the seat.
  Vec3 seated(const Vec3& p) const {
    const NearestPoint near = bone.nearest(p);
    const Vec3 away = p - near.point;
    const double distance = away.norm(), sign = bone.sign_at(p, near);
    const Vec3 normal = distance > 1e-6 ? Vec3(sign / distance * away) : bone_normal(near.triangle);
    return near.point + options.seat * normal;
  }
  Vec3 bone_normal(Index triangle) const {
    const auto corner = [&](int k) -> Vec3 {
      return bone.points().row(bone.triangles()(triangle, k));
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  }
  /// Points of one section, `share` of its full size.
  Section section(double hour, double share) const;
};

Section Ring::section(double hour, double share) const {
  const Vec3 centre = rim.clock.centre;
  const double edge = rim.height_at(hour);
  const double beside = kBesideCartilage / rim.radius;
  // where cartilage reaches over the edge the labrum begins beyond it
  const double base = std::max(edge, rim.cartilage_at(hour) + beside);
  const double inner =
      std::max(base - share * kInside / rim.radius, rim.cartilage_at(hour) + beside);
  const double tip = base + share * labrum_height(hour) / rim.radius;
  const Vec3 d = rim.direction(hour, edge);
  const auto hit = bone.first_hit(centre, rim.direction(hour, edge - 0.01), rim.radius + 9.0);
  const Vec3 on_edge = centre + (hit ? hit->distance : rim.radius + 1.0) * d;
  const Vec3 inside = centre + rim.radius * rim.direction(hour, inner);
  const Vec3 back = rim.direction(hour, edge - kPi / 2.0);  // into the socket, along its wall
  const Vec3 outside = on_edge + share * kOutside * (0.9 * d + 0.45 * back);

  Section points;
  for (int k = 0; k < kBase; ++k) {
    const double s = static_cast<double>(k) / (kBase - 1) * (kInside + kOutside) - kInside;
    const Vec3 p = s < 0.0 ? Vec3(on_edge + (s / -kInside) * (inside - on_edge))
                           : Vec3(on_edge + (s / kOutside) * (outside - on_edge));
    points[static_cast<std::size_t>(k)] = seated(p);
  }
  const auto on_head = [&](double height) -> Vec3 {
    return centre + (head(hour, height) + options.gap) * rim.direction(hour, height);
  };
  const Vec3 last = on_head(tip);
  points[kTip] = last;
  const Vec3 outer = points[kBase - 1];
  for (int k = 1; k <= kSide; ++k) {
    const double s = static_cast<double>(k) / (kSide + 1);
    const Vec3 chord = last - outer;
    points[static_cast<std::size_t>(kBase - 1 + k)] =
        outer + s * chord + 4.0 * s * (1.0 - s) * kBulge * chord.norm() * d;
    points[static_cast<std::size_t>(kTip + k)] = on_head(tip + s * (inner - tip));
  }
  return points;
}

/// Rings of points to a closed tube with flat ends.
TriMesh tube(const std::vector<Section>& sections) {
  const Index n = static_cast<Index>(sections.size());
  TriMesh mesh;
  mesh.points.resize(n * kSection + 2, 3);
  std::vector<std::array<Index, 3>> triangles;
  const auto at = [](Index i, int k) { return i * kSection + k % kSection; };
  for (Index i = 0; i < n; ++i) {
    for (int k = 0; k < kSection; ++k) {
      mesh.points.row(at(i, k)) =
          sections[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
      if (i + 1 == n) continue;
      triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      triangles.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
    }
  }
  for (int end = 0; end < 2; ++end) {
    const Index ring = end == 0 ? 0 : n - 1, middle = n * kSection + end;
    mesh.points.row(middle) = mesh.points.middleRows(ring * kSection, kSection).colwise().mean();
    for (int k = 0; k < kSection; ++k) {
      if (end == 0)
        triangles.push_back({at(ring, k + 1), at(ring, k), middle});
      else
        triangles.push_back({at(ring, k), at(ring, k + 1), middle});
    }
  }
  mesh.triangles = triangles_from(triangles);
  return mesh;
}

}  // namespace

double labrum_height(double hour) {
  std::size_t k = 0;
  while (k + 2 < kPlaces.size() && hour >= kPlaces[k + 1]) ++k;
  const double share = (hour - kPlaces[k]) / (kPlaces[k + 1] - kPlaces[k]);
  return (1.0 - share) * kHeights[k] + share * kHeights[k + 1];
}

namespace {

void check(const LabrumOptions& options) {
  require(options.spacing > 0.0 && options.seat > 0.0 && options.gap > 0.0,
          "spacing, seat and gap of a labrum must be positive");
}

/// The tube, kept out of what is around it.
TriMesh clear_tube(const std::vector<Section>& sections, const Ring& ring,
                   const TriMesh& cartilage) {
  TriMesh mesh = tube(sections);
  const TriangleTree cartilage_tree(cartilage.points, cartilage.triangles);
  std::vector<Obstacle> obstacles{{&ring.bone, ring.options.seat},
                                  {&cartilage_tree, ring.options.seat}};
  for (const TriangleTree& part : ring.head.parts()) obstacles.push_back({&part, ring.options.gap});
  update_clear(mesh, obstacles);
  return mesh;
}

/// Height, distance from the centre: the place of a point in its section.
Vec2 in_section(const SocketRim& rim, const Vec3& p) {
  const Vec3 d = p - rim.clock.centre;
  return {std::acos(-d.dot(rim.clock.axis) / d.norm()), d.norm()};
}

}  // namespace

TriMesh make_labrum(const SocketRim& rim, const TriMesh& hip_bone, const TriMesh& cartilage,
                    const std::vector<TriMesh>& head, const LabrumOptions& options) {
  check(options);
  const TriangleTree bone(hip_bone.points, hip_bone.triangles);
  const HeadRadius head_radius(rim, head);
  const Ring ring{rim, bone, head_radius, options};
  // from the posterior end over twelve to the anterior one
  const double begin = rim.notch_end, span = rim.notch_begin + 12.0 - rim.notch_end;
  const double length = span / 6.0 * kPi * rim.radius;
  const int n = std::max(8, static_cast<int>(length / options.spacing));
  std::vector<Section> sections(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index i) {
    const double s = static_cast<double>(i) / (n - 1);
    const double end = std::min(1.0, std::min(s, 1.0 - s) * length / kEndLength);
    sections[static_cast<std::size_t>(i)] =
        ring.section(std::fmod(begin + s * span, 12.0), kEndShare + (1.0 - kEndShare) * end);
  });
  return clear_tube(sections, ring, cartilage);
}

TriMesh make_transverse_ligament(const SocketRim& rim, const TriMesh& hip_bone,
                                 const TriMesh& cartilage, const std::vector<TriMesh>& head,
                                 const LabrumOptions& options) {
  check(options);
  const TriangleTree bone(hip_bone.points, hip_bone.triangles);
  const HeadRadius head_radius(rim, head);
  const Ring ring{rim, bone, head_radius, options};
  const double aside = kEndGap / rim.radius * 6.0 / kPi;
  const double begin = rim.notch_begin + aside, span = rim.notch_end - aside - begin;
  const Section from = ring.section(begin, kEndShare), to = ring.section(begin + span, kEndShare);
  const int n = std::max(8, static_cast<int>(span / 6.0 * kPi * rim.radius / options.spacing));
  std::vector<Section> sections(static_cast<std::size_t>(n));
  parallel_for(n, [&](Index i) {
    const double s = static_cast<double>(i) / (n - 1), hour = begin + s * span;
    for (std::size_t k = 0; k < kSection; ++k) {
      const Vec2 place = (1.0 - s) * in_section(rim, from[k]) + s * in_section(rim, to[k]);
      const double least = head_radius(hour, place[0]) + options.gap;
      const bool articular = k >= kTip;
      sections[static_cast<std::size_t>(i)][k] =
          rim.clock.centre +
          (articular ? least : std::max(place[1], least)) * rim.direction(hour, place[0]);
    }
  });
  return clear_tube(sections, ring, cartilage);
}

}  // namespace coxa::shape
