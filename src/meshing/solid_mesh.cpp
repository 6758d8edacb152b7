#include "solid_mesh.h"

#include "feature_curves.h"
#include "lattice.h"
#include "limits.h"
#include "misses.h"
#include "solid_guide.h"
#include "solid_improve.h"
#include "tet_boundary.h"

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/rebuild.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace coxa::meshing {
namespace {

constexpr double kFlatness = 0.15;     // mm, wanted; more where that asks for too many elements
constexpr double kShapeShare = 0.003;  // of the diagonal of the bounding box: flatness at most
constexpr double kSmallest = 2.0;      // times the flatness wanted: edge of the smallest cubes
constexpr double kMostUneven = 2.5;    // flatness over that wanted up to which cubes stay as small
constexpr double kLargest = 0.08;      // of the diagonal: edge of the largest cubes at the surface
constexpr double kCoarser = 1.3;       // growth of the flatness when elements are too many
constexpr int kSizeTries = 24;
constexpr double kMuchMissed = 0.25;    // mm, of the surface: worth another attempt
constexpr double kMissed = 0.3;         // mm, of the surface: a limit missed
constexpr int kMostTets = 200000;       // at first
constexpr int kMostFinerTets = 400000;  // where finer cubes are needed to meet the surface

// A lattice within the surface and the cubes it comes from.
struct Filling {
  Octree octree;
  TetGrid grid;
};

// Fills a surface from cubes unless they are sure to give too many elements, which their number
// tells once a first filling is known.
class Filler {
 public:
  Filler(const TriMesh& surface, const TriangleTree& tree) : surface_(surface), tree_(tree) {}

  // share of the elements allowed that the cubes give, about; the filling is left out where that is
  // clearly more than one
  std::pair<double, std::optional<Filling>> fill(const OctreeOptions& cubes, int max_tets) {
    constexpr double kClearly = 1.15;
    Octree octree(surface_, cubes);
    const auto n_cubes = static_cast<double>(octree.cells().size());
    const double guess = tets_per_cube_ * n_cubes / max_tets;
    if (guess > kClearly) return {guess, std::nullopt};
    TetGrid grid = stuffed(make_lattice(octree), tree_);
    const auto n_tets = static_cast<double>(grid.tets.size());
    tets_per_cube_ = n_tets / n_cubes;
    return {n_tets / max_tets, Filling{std::move(octree), std::move(grid)}};
  }

 private:
  const TriMesh& surface_;
  const TriangleTree& tree_;
  double tets_per_cube_ = 0.0;  // of the last filling
};

// where elements are too many, those of smooth parts grow first, then those of thin parts and
// ridges
OctreeOptions cubes_for(const TriMesh& surface, double wanted, double flatness) {
  return {.flatness = flatness,
          .smallest = kSmallest * std::max(wanted, flatness / kMostUneven),
          .largest = std::max(kLargest * bounds(surface.points).diagonal(), 4.0 * flatness)};
}

// lattice of as many elements as allowed
Filling fill_within(const TriMesh& surface, Filler& filler, int max_tets, OctreeOptions& cubes,
                    const Monitor& monitor) {
  const double wanted = std::min(kFlatness, kShapeShare * bounds(surface.points).diagonal());
  double flatness = wanted;
  for (int attempt = 0; attempt < kSizeTries; ++attempt) {
    monitor.check_cancelled();
    cubes = cubes_for(surface, std::min(wanted, flatness), flatness);
    auto [filled, made] = filler.fill(cubes, max_tets);
    if (filled > 0.0 && filled <= 1.0) return std::move(*made);
    // half the way that a smooth surface would need: cubes change by factors of two
    flatness *= filled > 0.0 ? std::max(kCoarser, std::sqrt(filled)) : 0.5;
  }
  fail(ErrorCode::below_quality, "no mesh of at most ", max_tets,
       " tetrahedra was found; allow more of them");
}

void add_notes(const TriMesh& surface, double flatness, MeshingReport& report) {
  constexpr double kWhole = 0.95;
  if (flatness > kFlatness)
    report.notes.push_back(join_text("the elements allowed follow the surface to within about ",
                                     flatness, " mm only, instead of ", kFlatness, " mm"));
  const double share = report.quality.volume / volume(surface);
  if (share < kWhole)
    report.notes.push_back(
        join_text("only ", 100.0 * share,
                  " % of the body is filled: it is thinner than the elements allowed"));
}

MeshingResult result_of(TetGrid& grid, const std::vector<Miss>& missed) {
  MeshingResult result;
  result.report.method = Method::lattice;
  for (const Miss& miss : missed)
    result.report.envelope = std::max(result.report.envelope, miss.distance);
  result.mesh = to_tet_mesh(grid);
  std::fill(result.mesh.facet_tags.begin(), result.mesh.facet_tags.end(), FacetTag::untagged);
  result.report.quality = tet_quality(result.mesh.points, result.mesh.tets);
  return result;
}

// the lattice made good; what of the surface it misses is told
MeshingResult improved(TetGrid grid, const SolidGuide& guide, const TriMesh& surface,
                       const MeshingOptions& options, std::vector<Miss>& missed,
                       const Monitor& monitor) {
  const Index dropped = improve_solid(
      grid, guide, surface, {options.improvement_rounds, options.max_tets.value_or(kMostFinerTets)},
      monitor);
  missed = misses(boundary_surface(grid), surface);
  MeshingResult result = result_of(grid, missed);
  if (dropped > 0)
    result.report.notes.push_back(
        join_text(dropped, " poor elements at the boundary were dropped"));
  return result;
}

bool any_much_missed(const std::vector<Miss>& missed) {
  return std::any_of(missed.begin(), missed.end(),
                     [](const Miss& m) { return m.distance > kMuchMissed; });
}

// half as large cubes where the surface was missed
void update_fine_places(const std::vector<Miss>& missed, const Octree& octree,
                        OctreeOptions& cubes) {
  constexpr double kAlsoMissed = 0.2;  // mm
  for (const Miss& miss : missed)
    if (miss.distance > kAlsoMissed)
      cubes.fine_places.push_back({miss.p, 0.5 * octree.size_at(miss.p)});
}

// ridges along which the mesh should run, where it misses the surface without that
FeatureCurves ridges_missed(const TriMesh& surface, const MeshingResult& made,
                            const MeshingOptions& options, const OctreeOptions& cubes) {
  // mm, of the surface: asked for, and where the number of elements is given and cubes cannot get
  // finer
  constexpr double kGivenNumber = 0.15;
  constexpr double kShortest = 3.0;         // of the smallest cubes
  constexpr std::size_t kMostCurves = 500;  // more of them are roughness, and take minutes
  if (made.report.envelope <= (options.max_tets ? kGivenNumber : kMissed)) return {};
  FeatureCurves found = feature_curves(surface, kShortest * cubes.smallest);
  return found.curves.size() <= kMostCurves ? found : FeatureCurves{};
}

// finer cubes where the surface was missed, and where they are too many, coarser ones where it is
// met well; or else as many of them as allowed everywhere
// @returns nullopt where that was tried already
std::optional<Filling> finer_filling(const TriMesh& surface, Filler& filler,
                                     const std::vector<Miss>& missed, const Octree& octree,
                                     int max_tets, int round, OctreeOptions& cubes,
                                     const Monitor& monitor) {
  constexpr int kCoarserTries = 2;
  update_fine_places(missed, octree, cubes);
  auto [filled, made] = filler.fill(cubes, max_tets);
  for (int k = 0; k < kCoarserTries && filled > 1.0; ++k) {
    cubes.flatness *= kCoarser;
    std::tie(filled, made) = filler.fill(cubes, max_tets);
  }
  if (filled <= 1.0) return std::move(made);
  if (round > 0) return std::nullopt;
  return fill_within(surface, filler, max_tets, cubes, monitor);
}

// the best of several fillings
MeshingResult filled(const TriMesh& surface, const MeshingOptions& options,
                     const Monitor& monitor) {
  constexpr int kFinerRounds = 3;
  const TriangleTree tree(surface.points, surface.triangles);
  const SolidGuide guide(tree);
  const int max_tets = options.max_tets.value_or(kMostTets);
  const int max_finer = options.max_tets.value_or(kMostFinerTets);
  OctreeOptions cubes;
  Filler filler(surface, tree);
  Filling filling =
      fill_within(surface, filler, max_tets, cubes, part_of(monitor, "lattice", 0.0, 0.4));
  OctreeOptions used = cubes;
  std::vector<Miss> missed;
  MeshingResult best = improved(std::move(filling.grid), guide, surface, options, missed,
                                part_of(monitor, "improve", 0.4, 0.7));
  for (int round = 0; round < kFinerRounds && any_much_missed(missed); ++round) {
    const Monitor part = part_of(monitor, "refine", 0.7 + 0.1 * round, 0.8 + 0.1 * round);
    auto made =
        finer_filling(surface, filler, missed, filling.octree, max_finer, round, cubes, part);
    if (!made) break;
    used = cubes;
    filling = std::move(*made);
    MeshingResult finer = improved(std::move(filling.grid), guide, surface, options, missed, part);
    if (nearer_to_limits(finer.report, best.report)) best = std::move(finer);
  }
  const SolidGuide along_ridges(tree, ridges_missed(surface, best, options, used));
  if (!along_ridges.features().curves.empty())
    if (auto again = filler.fill(used, max_finer).second) {
      MeshingResult other = improved(std::move(again->grid), along_ridges, surface, options, missed,
                                     part_of(monitor, "ridges", 0.9, 0.95));
      if (nearer_to_limits(other.report, best.report)) best = std::move(other);
    }
  add_notes(surface, used.flatness, best.report);
  return best;
}

// a surface whose parts too thin for any element became walls; nullopt where there are none
std::optional<TriMesh> with_walls(const TriMesh& surface) {
  constexpr double kSpacing = 0.2, kHalf = 0.15, kEdge = 0.5;  // mm
  constexpr double kMostSamples = 6e7;
  const Bounds box = bounds(surface.points);
  if ((box.high - box.low).prod() > kMostSamples * kSpacing * kSpacing * kSpacing)
    return std::nullopt;
  Rebuilt rebuilt =
      rebuild(surface, {.spacing = kSpacing, .thickening = kHalf, .target_edge = kEdge});
  if (!(rebuilt.thickened_area > 0.0)) return std::nullopt;
  return std::move(rebuilt.mesh);
}

}  // namespace

MeshingResult mesh_solid(const TriMesh& surface, const MeshingOptions& options,
                         const Monitor& monitor) {
  MeshingResult result = filled(surface, options, monitor);
  if (options.max_tets || result.report.envelope <= kMissed) return result;
  const std::optional<TriMesh> thick = with_walls(surface);
  if (!thick) return result;
  MeshingResult other = filled(*thick, options, part_of(monitor, "thin parts", 0.95, 1.0));
  other.report.envelope = envelope_error({other.mesh.points, other.mesh.facets}, surface);
  if (!nearer_to_limits(other.report, result.report)) return result;
  other.report.notes.emplace_back("parts too thin for elements became walls of 0.3 mm");
  return other;
}

}  // namespace coxa::meshing
