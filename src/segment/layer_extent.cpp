#include <coxa/segment/layer_extent.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/unfold.h>
#include <coxa/segment/joint_gap.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "coverage.h"
#include "interpolated.h"
#include "layer_sheet.h"
#include "rim_search.h"

namespace coxa::segment {
namespace {

// the rim is looked for so far to both sides of the present one, mm
constexpr double kReach = 10.0;
constexpr double kPatchReach = kReach + 2.0;
// passes of smoothing with the neighbours, about 1.3 mm apart
constexpr int kScorePasses = 3, kBonePasses = 4, kThicknessPasses = 4;
// bare bone, where nothing is measured, holds the border's move at 0 with this weight
constexpr double kBareWeight = 0.3;
// the other bone is no farther than this from a point under cartilage, mm
constexpr double kOtherBone = 14.0;
// brightness as of cartilage up to this near to the other bone means that the layers touch, mm
constexpr double kTouching = 0.8;
// a layer needs as much room between the other layer and its bone, mm, give or take
constexpr double kLeastRoom = 0.7, kRoomSpread = 0.4;
// so far inside the present rim, mm, cartilage may be found to be the other layer's
constexpr double kDisputed = 3.0;
// a layer that has no thickness here yet counts as this thick where two share the room, mm
constexpr double kLeastShare = 0.5;

// bones farther apart than this have more than two layers between them, mm
constexpr double kWidestRoom = 8.0;
// layers that end farther apart than this have more than a line between them, mm
constexpr double kWidestGap = 1.2;
// between layers that touch as far as an image tells lies a film: 0.35 mm (0.25 to 0.45) in the
// middle of 18 hips of nine men; not more than this share of the room
constexpr double kFilm = 0.35, kLargestFilmShare = 0.25;
// the line between two layers is told to this, mm, or not at all; not better than the second; and
// the layers' present share of the room is as good as the third
constexpr double kToldApart = 0.5, kLeastDeviation = 0.15, kExpected = 0.4;

/// One layer with what the images say about it.
struct Measured {
  HostPatch patch;
  Coverage coverage;
  LayerSheet sheet;
  VecX thickness;  ///< present, per sheet vertex, mm
  bool usable() const { return coverage.separation >= kTellsApart; }
};

std::vector<Measured> measured(const std::vector<ExtentLayer>& layers,
                               std::span<const PreparedImage> images,
                               std::span<const double> blur) {
  std::vector<Measured> all;
  std::vector<HostPatch> patches;
  for (const ExtentLayer& layer : layers) {
    Measured m;
    m.sheet = sheet_of(*layer.layer, layer.n_bone_side);
    m.thickness = thickness_of(m.sheet, layer.layer->points);
    patches.push_back(patch_about(*layer.host, m.sheet.sheet, kPatchReach));
    all.push_back(std::move(m));
  }
  std::vector<Coverage> coverages = coverages_of(patches, images, blur);
  for (std::size_t l = 0; l < layers.size(); ++l) {
    all[l].patch = std::move(patches[l]);
    all[l].coverage = std::move(coverages[l]);
  }
  return all;
}

/// Takes the host's vertices, and the patch's, to the border found beneath the layer.
/// @returns how far the patch's vertices go, mm outwards
VecX update_host(TriMesh& host, Measured& m) {
  const VecX weight = m.coverage.known.array().max(kBareWeight);
  const VecX found = (m.coverage.known.array() > 0.0).select(m.coverage.bone, 0.0);
  const VecX move = smoothed_on(m.patch, found, weight, kBonePasses);
  m.patch.mesh.points += move.asDiagonal() * m.patch.normals;
  for (std::size_t v = 0; v < m.patch.host_vertex.size(); ++v)
    host.points.row(m.patch.host_vertex[v]) = m.patch.mesh.points.row(static_cast<Index>(v));
  update_unfolded(host);
  return move;
}

/// Present thickness of a layer near a point; 0 where it is not.
class PresentThickness {
 public:
  explicit PresentThickness(const Measured& m)
      : m_(m), tree_(m.sheet.sheet.points, m.sheet.sheet.triangles) {}
  double operator()(const Vec3& p) const {
    constexpr double kOnSheet = 2.0;  // mm
    const auto at = tree_.nearest_within(p, kOnSheet);
    return at ? interpolated(m_.thickness, m_.sheet.sheet.triangles, *at) : 0.0;
  }

 private:
  const Measured& m_;
  TriangleTree tree_;
};

/// The layer across the joint, as far as it shares the room.
struct Opposite {
  const Measured* layer = nullptr;
  std::optional<TriangleTree> bone;
  std::optional<PresentThickness> thickness;
};

std::vector<Opposite> opposites_of(const std::vector<Measured>& all, std::size_t layer) {
  std::vector<Opposite> others;
  for (std::size_t m = 0; m < all.size(); ++m) {
    if (m == layer) continue;
    const TriMesh& patch = all[m].patch.mesh;
    Opposite other{&all[m], TriangleTree(patch.points, patch.triangles), std::nullopt};
    other.thickness.emplace(all[m]);
    others.push_back(std::move(other));
  }
  return others;
}

/// Near the present rim and beside it, cartilage that begins where the other layer does is the
/// other's: what lies before it is not the host's cortex but a dark wedge on bare bone, or the
/// host's border is wrong there.
/// @param moved mm outwards, of the patch's vertices since the rays were cast
void update_claims(Measured& m, const VecX& moved, const std::vector<Opposite>& others) {
  VecX& score = m.coverage.score;
  parallel_for(static_cast<std::int64_t>(score.size()), [&](Index v) {
    if (m.patch.rim_distance[v] >= kDisputed) return;
    const Vec3 p = m.patch.mesh.points.row(v), normal = m.patch.normals.row(v);
    const double begins = std::max(m.coverage.bone[v] - moved[v], 0.0);
    for (const Opposite& other : others) {
      const auto hit = other.bone->first_hit(p, normal, kOtherBone);
      if (!hit) continue;
      const double theirs = hit->distance - (*other.thickness)(p + hit->distance * normal);
      const double room = (theirs - begins - kLeastRoom) / kRoomSpread;
      score[v] = std::min(score[v], std::max(room, -1.0));
    }
  });
}

/// Ways from a layer's patch to the other bone where both are covered.
void append_ways(const Measured& m, const std::vector<Opposite>& others,
                 std::vector<GapRay>& rays) {
  for (Index v = 0; v < static_cast<Index>(m.coverage.score.size()); ++v) {
    if (m.coverage.score[v] <= 0.0) continue;
    const Vec3 p = m.patch.mesh.points.row(v), normal = m.patch.normals.row(v);
    for (const Opposite& other : others) {
      const auto hit = other.bone->first_hit(p, normal, kWidestRoom);
      if (hit && interpolated(other.layer->coverage.score, other.bone->triangles(), *hit) > 0.0)
        rays.push_back({v, p, normal, hit->distance});
    }
  }
}

/// Where each layer and the one across part, by patch vertex, mm; the deviation is infinite where
/// nothing is told.
std::vector<std::vector<GapFit>> gaps_of(const std::vector<Measured>& all,
                                         const std::vector<std::vector<Opposite>>& opposites,
                                         std::span<const PreparedImage> images,
                                         std::span<const double> blur) {
  std::vector<GapRay> rays;
  std::vector<std::size_t> end;
  for (std::size_t l = 0; l < all.size(); ++l) {
    append_ways(all[l], opposites[l], rays);
    end.push_back(rays.size());
  }
  const std::vector<GapFit> fits = gaps_between(rays, images, blur);
  std::vector<std::vector<GapFit>> gaps;
  std::size_t i = 0;
  for (std::size_t l = 0; l < all.size(); ++l) {
    gaps.emplace_back(static_cast<std::size_t>(all[l].coverage.score.size()));
    for (; i < end[l]; ++i) gaps[l][static_cast<std::size_t>(rays[i].vertex)] = fits[i];
  }
  return gaps;
}

/// The room between two bones that their layers may fill, mm: less a film, where the image does not
/// show lines between layers anyway.
double fillable(double room, const GapFit& gap) {
  if (std::isfinite(gap.deviation)) return room;
  return room - std::min(kFilm, kLargestFilmShare * room);
}

/// One layer's part of the room between two bones, mm, as the layers' present share has it and,
/// where it is told, the line between them.
double share_of(double room, double present_share, const GapFit& gap, bool parted) {
  const double middle = room * present_share;
  if (!parted) return middle - 0.5 * (room - fillable(room, gap));
  const double told = 1.0 / (gap.deviation * gap.deviation + kLeastDeviation * kLeastDeviation),
               expected = 1.0 / (kExpected * kExpected);
  return (told * gap.middle + expected * middle) / (told + expected) - 0.5 * gap.width;
}

/// Thickness along the patch's normals: what the brightness shows, less what is the other layer's.
VecX own_thickness(const Measured& m, const std::vector<Opposite>& others,
                   const std::vector<GapFit>& gaps) {
  const PresentThickness present(m);
  VecX own(m.coverage.thickness.size());
  parallel_for(static_cast<std::int64_t>(own.size()), [&](Index v) {
    const Vec3 p = m.patch.mesh.points.row(v), normal = m.patch.normals.row(v);
    // where the image is blurred the present thickness is as good
    const double known = m.coverage.known[v], before = present(p);
    own[v] = before > 0.0 ? known * m.coverage.thickness[v] + (1.0 - known) * before
                          : m.coverage.thickness[v];
    for (const Opposite& other : others) {
      const auto hit = other.bone->first_hit(p, normal, kOtherBone);
      if (!hit) continue;
      const GapFit& gap = gaps[static_cast<std::size_t>(v)];
      const double theirs_measured =
          interpolated(other.layer->coverage.thickness, other.bone->triangles(), *hit);
      const double measured = own[v] + theirs_measured, touching = hit->distance - kTouching;
      const bool parted = gap.deviation < kToldApart && hit->distance - measured < kWidestGap;
      const bool covered =
          interpolated(other.layer->coverage.score, other.bone->triangles(), *hit) > 0.0;
      if (own[v] < touching && !parted) {
        // both are seen to end, but, blurred, may seem to need more room than there is
        if (covered && theirs_measured < touching)
          own[v] *= std::min(1.0, fillable(hit->distance, gap) / measured);
        continue;
      }
      if (!covered) {
        own[v] = std::min(own[v], hit->distance);
        continue;
      }
      const double mine = std::max(before, kLeastShare);
      const double theirs = std::max((*other.thickness)(p + hit->distance * normal), kLeastShare);
      own[v] = share_of(hit->distance, mine / (mine + theirs), gap, parted);
    }
  });
  return smoothed_on(m.patch, own, m.coverage.known, kThicknessPasses);
}

/// Lays the layer on the rim found with the thickness found.
void update_layer(TriMesh& layer, const Measured& m, const VecX& thickness) {
  const TriMesh sheet = sheet_to_rim(m.sheet.sheet, m.patch, m.coverage.score,
                                     {.search = kReach, .hidden = m.coverage.hidden});
  const TriangleTree tree(m.patch.mesh.points, m.patch.mesh.triangles);
  for (Index v = 0; v < sheet.n_vertices(); ++v) {
    const Index opposite = m.sheet.opposite[static_cast<std::size_t>(v)];
    const Vec3 p = sheet.points.row(v);
    const NearestPoint at = tree.nearest(p);
    const Vec3 normal = interpolated(m.patch.normals, m.patch.mesh.triangles, at);
    layer.points.row(v) = p;
    if (opposite == v) continue;
    layer.points.row(opposite) =
        p + interpolated(thickness, m.patch.mesh.triangles, at) * normal.normalized();
  }
}

}  // namespace

std::vector<FoundExtent> update_extents(std::vector<ExtentLayer>& layers,
                                        std::span<const PreparedImage> images,
                                        std::span<const double> blur) {
  std::vector<Measured> all = measured(layers, images, blur);
  std::vector<FoundExtent> found;
  for (const Measured& m : all) found.push_back({m.coverage.separation, false});
  std::vector<VecX> moved;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    moved.push_back(all[l].usable() ? update_host(*layers[l].host, all[l])
                                    : VecX::Zero(all[l].coverage.bone.size()));
  }
  std::vector<std::vector<Opposite>> opposites;
  for (std::size_t l = 0; l < layers.size(); ++l) opposites.push_back(opposites_of(all, l));
  for (std::size_t l = 0; l < layers.size(); ++l) update_claims(all[l], moved[l], opposites[l]);
  for (Measured& m : all) {
    VecX& score = m.coverage.score;
    score = smoothed_on(m.patch, score, VecX::Ones(score.size()), kScorePasses);
  }
  const auto gaps = gaps_of(all, opposites, images, blur);
  std::vector<VecX> thickness;
  for (std::size_t l = 0; l < layers.size(); ++l)
    thickness.push_back(own_thickness(all[l], opposites[l], gaps[l]));
  for (std::size_t l = 0; l < layers.size(); ++l) {
    if (!all[l].usable()) continue;
    TriMesh layer = *layers[l].layer;
    update_layer(layer, all[l], thickness[l]);
    found[l].folds = !update_unfolded(layer);
    if (!found[l].folds) *layers[l].layer = std::move(layer);
  }
  return found;
}

}  // namespace coxa::segment
