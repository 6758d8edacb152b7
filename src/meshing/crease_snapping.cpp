#include "crease_snapping.h"

#include "worst_elements.h"

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

constexpr double kReach = 0.35;       // of the mean edge length around a node
constexpr double kWorstEnergy = 8.0;  // shape energy allowed just after snapping

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double mean_edge(const TetGrid& grid, Index v) {
  double sum = 0.0;
  int count = 0;
  for (const Index t : grid.around[at(v)]) {
    for (const Index u : grid.tets[at(t)]) {
      if (u == v) continue;
      sum += (grid.x[at(u)] - grid.x[at(v)]).norm();
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / count;
}

}  // namespace

Index snap_to_creases(TetGrid& grid, const SheetGuide& guide) {
  Index snapped = 0;
  for (Index v = 0; v < static_cast<Index>(grid.x.size()); ++v) {
    const NodeKind kind = grid.kinds[at(v)];
    if (kind != NodeKind::first_face && kind != NodeKind::second_face) continue;
    const auto target = guide.nearest_crease(kind, grid.x[at(v)]);
    if (!target) continue;
    const Vec3 old = grid.x[at(v)];
    if ((*target - old).norm() > kReach * mean_edge(grid, v)) continue;
    const double allowed = std::max(kWorstEnergy, 1.5 * worst_energy(grid, v));
    grid.x[at(v)] = *target;
    if (worst_energy(grid, v) > allowed) {
      grid.x[at(v)] = old;
      continue;
    }
    grid.kinds[at(v)] =
        kind == NodeKind::first_face ? NodeKind::first_crease : NodeKind::second_crease;
    ++snapped;
  }
  return snapped;
}

}  // namespace coxa::meshing
