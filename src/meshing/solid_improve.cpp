#include "solid_improve.h"

#include "cover.h"
#include "curve_paths.h"
#include "flips.h"
#include "lattice.h"
#include "mending.h"
#include "node_freedom.h"
#include "node_smoothing.h"
#include "worst_elements.h"

#include <algorithm>
#include <vector>

namespace coxa::meshing {
namespace {

// boundary nodes go to the surface, as far as the elements allow it
void draw_to_surface(TetGrid& grid, const SolidGuide& guide) {
  constexpr double kWorst = 6.0;  // shape energy allowed just then
  for (std::size_t v = 0; v < grid.x.size(); ++v) {
    if (grid.kinds[v] == NodeKind::inside || grid.around[v].empty()) continue;
    const Vec3 old = grid.x[v], home = guide.place(grid.kinds[v], old);
    const double share = draw_node(grid, static_cast<Index>(v), home, kWorst);
    grid.reach[v] = share < 1.0 ? (1.0 - share) * (home - old).norm() : 0.0;
  }
}

enum class Connections { may_change, stay };

void improve(TetGrid& grid, const SolidGuide& guide, const TriMesh& surface,
             const SolidImprovement& options, Connections connections, const Monitor& monitor) {
  const int rounds = options.rounds;
  constexpr int kMeanRounds = 4;  // first the average, then the worst
  constexpr int kCoverRounds = 3;
  constexpr std::size_t kMostCovered = 1500;  // where more are missed, finer cubes come next
  const auto flip = [&](double below) {
    if (connections == Connections::may_change)
      flip_poor(grid, guide,
                {.below = below,
                 .max_tets = options.max_tets,
                 .at_creases = !guide.features().curves.empty()});
  };
  for (int k = 0; k < rounds; ++k) {
    monitor.check_cancelled();
    monitor.progress("improve", static_cast<double>(k) / rounds);
    update_positions(grid, guide, k < kMeanRounds ? 1.0 : 3.0);
    draw_to_surface(grid, guide);
    if (k > 0) flip(0.5);
  }
  const auto room = [&]() -> std::ptrdiff_t {
    return connections == Connections::may_change ? options.max_tets - grid.n_living() : 0;
  };
  for (int k = 0; k < kCoverRounds &&
                  cover_far_places(grid, surface, {.most = kMostCovered, .room = room()}) > 0;
       ++k) {
    flip(0.5);
    update_positions(grid, guide, 3.0);
  }
  for (int k = 0; k < rounds && raise_worst(grid, guide) > 0; ++k) {
    monitor.check_cancelled();
    flip(0.35);
  }
  if (rounds > 0) raise_freely(grid, guide);
  draw_back(grid, guide);
  for (int k = 0; rounds > 0 && k < kCoverRounds; ++k) {
    if (cover_far_places(grid, surface, {.most = kMostCovered, .room = room()}) == 0) break;
    flip(0.35);
    raise_worst(grid, guide);
  }
  if (rounds > 0 && has_poor_element(grid)) raise_freely(grid, guide);
}

// nodes go to the feature curves and corners, step by step
void draw_to_curves(TetGrid& grid, const SolidGuide& guide, int max_tets) {
  constexpr int kRounds = 8;
  if (guide.features().curves.empty()) return;
  const TetGrid before = grid;
  const std::vector<FeatureNode> chosen = choose_paths(grid, guide.features());
  for (int round = 0; round < kRounds; ++round) {
    draw_to_features(grid, guide.features(), chosen);
    draw_to_surface(grid, guide);
    update_positions(grid, guide, 1.0);
    flip_poor(grid, guide, {.below = 0.5, .max_tets = max_tets, .at_creases = true});
  }
  release_missed(grid, guide.features(), chosen);
  if (!pinched_nodes(grid).empty()) grid = before;
}

}  // namespace

Index improve_solid(TetGrid& grid, const SolidGuide& guide, const TriMesh& surface,
                    const SolidImprovement& options, const Monitor& monitor) {
  draw_to_surface(grid, guide);
  draw_to_curves(grid, guide, options.max_tets);
  const TetGrid start = grid;
  improve(grid, guide, surface, options, Connections::may_change, monitor);
  const Index dropped = drop_poor_elements(grid);
  if (pinched_nodes(grid).empty()) return dropped;
  // where thin parts fold over themselves changed connections may touch: keep the lattice's
  grid = start;
  improve(grid, guide, surface, options, Connections::stay, monitor);
  return 0;
}

}  // namespace coxa::meshing
