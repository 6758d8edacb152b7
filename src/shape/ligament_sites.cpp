#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/shape/ligaments.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace coxa::shape {
namespace {

constexpr int kFibres = 7;
// mm between points of a fibre on bone
constexpr double kMarch = 1.5;
// mm before the socket from where its rim is looked at; mm between points that tell of two surfaces
constexpr double kFarBefore = 40.0, kJump = 6.0;
// mm from the edge where the capsule begins, outside the labrum's base
constexpr double kBesideLabrum = 4.0;
// Origins by hours about the rim, 6 in the notch's middle (Nam et al. 2011): iliofemoral 12:35 to
// 2:18, ischiofemoral 8:44 to 11:45, pubofemoral 4:02 to 5:27.
constexpr double kIliofemoral[] = {12.58, 14.30}, kIschiofemoral[] = {8.73, 11.75},
                 kPubofemoral[] = {4.03, 5.45};
// Their depth on the bone, mm: footprint areas of 4.2, 6.4 and 1.4 cm² (Telleria et al. 2014) over
// the arcs' lengths.
constexpr double kIliofemoralDepth = 17.0, kIschiofemoralDepth = 15.0, kPubofemoralDepth = 7.0;
// hours left between the two bands of the iliofemoral ligament, so that they stay two surfaces
constexpr double kBetweenBands = 0.1;
// The capsule's thickness, mm: 6 anterosuperiorly (Weidner et al. 2012), 4.1 where it is thinnest
// (Philippon et al. 2014).
constexpr double kThick = 6.0, kThin = 4.1;
// The intertrochanteric line, mm below the greater trochanter's tip, and its length: footprints
// of 23.0 and 17.9 mm are its proximal 42 % and its distal third (Tamaki et al.): 54 mm. The bands'
// widths on the bone are theirs, too.
constexpr double kLineBelowTip = 15.0, kLineLength = 54.0;
constexpr double kTransverse[] = {0.0, 0.42}, kDescending[] = {0.67, 1.0};
constexpr double kTransverseWidth = 9.7, kDescendingWidth = 9.0;
// The ischiofemoral ligament ends on the femur over 11.3 by 6.9 mm, in front of the neck's axis
// (Tamaki et al.).
constexpr double kIschioLength = 11.3, kIschioWidth = 6.9, kBeforeAxis = 4.0;
// mm by which the greater trochanter has begun to rise from the neck there
constexpr double kRise = 4.0;
// The pubofemoral ligament has no insertion of its own (Telleria et al.): it ends under the neck's
// base beside the iliofemoral, mm beyond the neck's middle and before its axis, over a width as of
// its origin.
constexpr double kBeyondNeck = 10.0, kPuboBefore = 6.0, kPuboWidth = 14.0, kPuboLength = 6.0;
// The fovea lies behind and below the head's apex (Perumal et al.), 17.7 by 13 mm; the ligament's
// attachment is its upper half.
constexpr double kFoveaBack = 0.25, kFoveaDown = 0.35, kFoveaWidth = 9.0, kFoveaLength = 8.0;
// The head's ligament: mm; no better figure than that it is a somewhat flattened band. It springs
// from the notch's whole width.
constexpr double kHeadLigament = 3.0;
constexpr double kFossaHeight = 0.2;  // rad from the transverse ligament into the fossa

/// Bone to put points on.
class Ground {
 public:
  explicit Ground(const TriMesh& mesh) : tree_(mesh.points, mesh.triangles) {}
  std::optional<Vec3> first_along(const Vec3& from, const Vec3& way) const {
    const auto hit = tree_.first_hit(from, way.normalized(), 2.0 * way.norm());
    return hit ? std::optional<Vec3>(from + hit->distance * way.normalized()) : std::nullopt;
  }
  /// First place of the bone on the way from `from` towards `to` and beyond.
  Vec3 seen_from(const Vec3& from, const Vec3& to, const char* what) const {
    const auto place = first_along(from, to - from);
    require(place.has_value(), "the bones show no place for the ", what);
    return *place;
  }

 private:
  TriangleTree tree_;
};

/// Points on the bone from `depth` to the rim's outer side, along the meridian of an hour: seen
/// from before the socket.
std::vector<Vec3> down_to_rim(const SocketRim& rim, const Ground& bone, double hour, double depth) {
  const double edge = rim.height_at(std::fmod(hour, 12.0));
  const Vec3 out = rim.direction(std::fmod(hour, 12.0), kPi / 2.0);
  const Vec3 first = rim.clock.centre + rim.radius * rim.direction(std::fmod(hour, 12.0), edge);
  const Vec3 ahead = kFarBefore * rim.clock.axis;
  std::vector<Vec3> chain;
  double gone = 0.0;
  std::optional<Vec3> last;
  for (double aside = 1.0; gone < kBesideLabrum + depth && aside < 2.0 * depth + 20.0;
       aside += 0.5) {
    const auto here = bone.first_along(first + aside * out + ahead, -ahead);
    if (!here) continue;
    // beyond an edge lies something else: first the wall of the socket, last what is behind the
    // bone
    const bool jump = last && (*here - *last).norm() > kJump;
    if (jump && !chain.empty()) break;
    if (last && !jump) gone += (*here - *last).norm();
    last = here;
    if (gone >= kBesideLabrum && (chain.empty() || (*here - chain.back()).norm() >= kMarch))
      chain.push_back(*here);
  }
  require(!chain.empty(), "the bone beside the socket's rim is too narrow for a ligament, at ",
          std::fmod(hour, 12.0), " o'clock");
  std::reverse(chain.begin(), chain.end());
  return chain;
}

std::vector<std::vector<Vec3>> origins(const SocketRim& rim, const Ground& bone, double from,
                                       double to, double depth) {
  std::vector<std::vector<Vec3>> chains;
  for (int j = 0; j < kFibres; ++j)
    chains.push_back(down_to_rim(rim, bone, from + (to - from) * j / (kFibres - 1), depth));
  return chains;
}

/// A patch on the bone, seen from `from`: fibres along `side`, each running along `run`.
std::vector<std::vector<Vec3>> patch(const Ground& bone, const Vec3& from, const Vec3& middle,
                                     const Vec3& side, const Vec3& run, const char* what) {
  std::vector<std::vector<Vec3>> chains;
  for (int j = 0; j < kFibres; ++j) {
    std::vector<Vec3> chain;
    for (const double r : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const Vec3 shift = (static_cast<double>(j) / (kFibres - 1) - 0.5) * side + r * run;
      chain.push_back(bone.seen_from(from + shift, middle + shift, what));
    }
    chains.push_back(chain);
  }
  return chains;
}

struct FemurAxes {
  Vec3 neck;      // out of the head into the shaft
  Vec3 anterior;  // across the neck
  Vec3 superior;  // across both
};

FemurAxes axes_of(const FemurMarks& marks) {
  FemurAxes axes;
  axes.neck = (marks.neck_centre - marks.head_centre).normalized();
  const Vec3 down = marks.lesser_trochanter - marks.greater_trochanter;
  axes.anterior = axes.neck.cross(down).normalized();
  if (axes.anterior.y() > 0.0) axes.anterior = -axes.anterior;
  axes.superior = axes.neck.cross(axes.anterior).normalized();
  if (axes.superior.z() < 0.0) axes.superior = -axes.superior;
  return axes;
}

/// Band of the iliofemoral ligament to a part of the intertrochanteric line.
std::vector<std::vector<Vec3>> on_line(const Ground& bone, const FemurMarks& marks,
                                       const double part[2], double width) {
  const FemurAxes axes = axes_of(marks);
  const Vec3 along = (marks.lesser_trochanter - marks.greater_trochanter).normalized();
  const Vec3 anterior = (axes.anterior - axes.anterior.dot(along) * along).normalized();
  const double middle = kLineBelowTip + 0.5 * (part[0] + part[1]) * kLineLength;
  const Vec3 inside = marks.greater_trochanter + middle * along;
  const Vec3 outward = along.cross(anterior);  // across the line; away from the head below
  const Vec3 run = (outward.dot(axes.neck) > 0.0 ? outward : Vec3(-outward)) * width;
  return patch(bone, inside + 60.0 * anterior, inside, (part[1] - part[0]) * kLineLength * along,
               run, "intertrochanteric line");
}

std::vector<std::vector<Vec3>> beside_trochanter(const Ground& bone, const FemurMarks& marks) {
  const FemurAxes axes = axes_of(marks);
  const double neck = (marks.neck_centre - marks.head_centre).norm();
  double lowest = kInfinity;
  Vec3 place = marks.neck_centre;
  for (double t = neck - 5.0; t < neck + 35.0; t += 1.0) {
    const Vec3 inside = marks.head_centre + t * axes.neck + kBeforeAxis * axes.anterior;
    const Vec3 top =
        bone.seen_from(inside + 70.0 * axes.superior, inside, "ischiofemoral ligament");
    const double height = (top - inside).dot(axes.superior);
    lowest = std::min(lowest, height);
    place = inside;
    if (height > lowest + kRise) break;
  }
  return patch(bone, place + 70.0 * axes.superior, place, kIschioLength * axes.neck,
               kIschioWidth * axes.anterior, "ischiofemoral ligament");
}

std::vector<std::vector<Vec3>> under_neck(const Ground& bone, const FemurMarks& marks) {
  const FemurAxes axes = axes_of(marks);
  const Vec3 inside = marks.neck_centre + kBeyondNeck * axes.neck + kPuboBefore * axes.anterior;
  return patch(bone, inside - 60.0 * axes.superior, inside, -kPuboWidth * axes.anterior,
               kPuboLength * axes.neck, "pubofemoral ligament");
}

LigamentSite head_ligament(const SocketRim& rim, const Ground& femur, const FemurMarks& marks) {
  const FemurAxes axes = axes_of(marks);
  LigamentSite site{"ligament_of_head_of_femur", kHeadLigament, {}, {}};
  const Vec3 apex = -axes.neck;
  const Vec3 fovea = (apex - kFoveaBack * axes.anterior - kFoveaDown * axes.superior).normalized();
  const Vec3 upward = (axes.superior - axes.superior.dot(fovea) * fovea).normalized();
  const Vec3 side = fovea.cross(upward);
  for (int j = 0; j < kFibres; ++j) {
    const double s = static_cast<double>(j) / (kFibres - 1);
    const double hour = rim.notch_begin + (0.15 + 0.7 * s) * (rim.notch_end - rim.notch_begin);
    std::vector<Vec3> from, to;
    for (const double into : {0.0, 0.5, 1.0}) {
      const double height = rim.height_at(hour) - into * kFossaHeight;
      from.push_back(rim.clock.centre + (rim.radius + 2.5) * rim.direction(hour, height));
    }
    const Vec3 far = marks.head_centre + 60.0 * fovea;
    for (const double r : {-0.5, 0.0, 0.5}) {
      const Vec3 shift = (0.5 - s) * kFoveaWidth * side + r * kFoveaLength * upward;
      to.push_back(femur.seen_from(far + shift, marks.head_centre + shift, "fovea"));
    }
    site.origin.push_back(from);
    site.insertion.push_back(to);
  }
  // the fibre that springs in front comes in front
  if ((site.origin.front().front() - site.origin.back().front())
          .dot(site.insertion.front().front() - site.insertion.back().front()) < 0.0)
    std::reverse(site.insertion.begin(), site.insertion.end());
  return site;
}

}  // namespace

const std::vector<std::string>& generic_ligament_names() {
  static const std::vector<std::string> names{
      "iliofemoral_ligament_transverse", "iliofemoral_ligament_descending", "pubofemoral_ligament",
      "ischiofemoral_ligament", "ligament_of_head_of_femur"};
  return names;
}

std::vector<LigamentSite> find_ligament_sites(const SocketRim& rim, const TriMesh& hip_bone,
                                              const TriMesh& femur, const FemurMarks& marks) {
  const Ground pelvis(hip_bone), thigh(femur);
  const double middle = 0.5 * (kIliofemoral[0] + kIliofemoral[1]);
  std::vector<LigamentSite> sites;
  sites.push_back({"iliofemoral_ligament_transverse", kThick,
                   origins(rim, pelvis, kIliofemoral[0], middle - kBetweenBands, kIliofemoralDepth),
                   on_line(thigh, marks, kTransverse, kTransverseWidth)});
  sites.push_back({"iliofemoral_ligament_descending", kThick,
                   origins(rim, pelvis, middle + kBetweenBands, kIliofemoral[1], kIliofemoralDepth),
                   on_line(thigh, marks, kDescending, kDescendingWidth)});
  sites.push_back({"pubofemoral_ligament", kThin,
                   origins(rim, pelvis, kPubofemoral[0], kPubofemoral[1], kPubofemoralDepth),
                   under_neck(thigh, marks)});
  // its fibres turn: the uppermost end outermost beside the trochanter
  sites.push_back({"ischiofemoral_ligament", kThin,
                   origins(rim, pelvis, kIschiofemoral[1], kIschiofemoral[0], kIschiofemoralDepth),
                   beside_trochanter(thigh, marks)});
  sites.push_back(head_ligament(rim, thigh, marks));
  return sites;
}

}  // namespace coxa::shape
