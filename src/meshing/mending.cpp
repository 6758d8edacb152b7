#include "mending.h"

#include "grid_topology.h"
#include "node_freedom.h"
#include "node_smoothing.h"
#include "worst_elements.h"

#include <algorithm>
#include <vector>

namespace coxa::meshing {
namespace {

// ranks of an element (see `element_rank`): aimed at, and good enough to leave the surface alone
constexpr double kAim = 1.0, kGoodEnough = 0.84;
// an element below this is worth less than the place it fills
constexpr double kPoor = 0.82;
constexpr int kRounds = 6;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::vector<char> corners_below(const TetGrid& grid, double rank) {
  std::vector<char> found(grid.x.size(), 0);
  for (const Tet& t : grid.tets) {
    if (t[0] < 0 || element_rank(grid, t) >= rank) continue;
    for (const Index v : t) found[at(v)] = 1;
  }
  return found;
}

std::vector<char> with_neighbours(const TetGrid& grid, const std::vector<char>& marked) {
  std::vector<char> more = marked;
  for (const Tet& t : grid.tets) {
    if (t[0] < 0) continue;
    if (std::any_of(t.begin(), t.end(), [&](Index v) { return marked[at(v)] != 0; }))
      for (const Index v : t) more[at(v)] = 1;
  }
  return more;
}

void let_all_go(TetGrid& grid, const std::vector<char>& marked, double reach) {
  for (std::size_t v = 0; v < marked.size(); ++v)
    if (marked[v]) let_go(grid, static_cast<Index>(v), reach);
}

// taking the element away must only push the boundary in: its outer facets form one disc
bool may_go(const TetGrid& grid, Index t) {
  const Tet& tet = grid.tets[at(t)];
  std::vector<std::size_t> outer;  // corners opposite to facets on the boundary
  for (std::size_t k = 0; k < 4; ++k)
    if (on_boundary(grid, facet_opposite(tet, k))) outer.push_back(k);
  if (outer.size() == 1) return !node_on_boundary(grid, tet[outer[0]]);
  // two outer facets share the edge of the two other corners; what becomes an edge of the boundary
  // is the one between the corners opposite to them
  if (outer.size() == 2) return !edge_on_boundary(grid, tet[outer[0]], tet[outer[1]]);
  if (outer.size() != 3) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool tip = std::find(outer.begin(), outer.end(), k) == outer.end();
    if (tip) return grid.around[at(tet[k])].size() == 1;
  }
  return false;
}

}  // namespace

Index untangle_freely(TetGrid& grid, const SlideGuide& guide) {
  Index inverted = count_inverted(grid);
  for (const double reach : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2}) {
    if (inverted == 0) break;
    std::vector<char> marked = with_neighbours(grid, corners_below(grid, 1e-3));
    if (reach > 0.5) marked = with_neighbours(grid, marked);
    let_all_go(grid, marked, reach);
    inverted = untangle(grid, guide);
  }
  return inverted;
}

void raise_freely(TetGrid& grid, const SlideGuide& guide) {
  for (const double reach : {0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8}) {
    const std::vector<char> marked = corners_below(grid, reach < 0.12 ? kAim : kGoodEnough);
    if (std::none_of(marked.begin(), marked.end(), [](char m) { return m != 0; })) return;
    let_all_go(grid, marked, reach);
    for (int round = 0; round < kRounds && raise_worst(grid, guide) > 0; ++round) continue;
  }
}

bool has_poor_element(const TetGrid& grid) {
  return std::any_of(grid.tets.begin(), grid.tets.end(), [&](const Tet& t) {
    return t[0] >= 0 && element_rank(grid, t) < kGoodEnough;
  });
}

Index drop_poor_elements(TetGrid& grid) {
  Index dropped = 0;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t t = 0; t < grid.tets.size(); ++t) {
      if (!grid.alive(static_cast<Index>(t)) || element_rank(grid, grid.tets[t]) >= kPoor) continue;
      if (!may_go(grid, static_cast<Index>(t))) continue;
      grid.remove(static_cast<Index>(t));
      ++dropped;
      again = true;
    }
  }
  return dropped;
}

}  // namespace coxa::meshing
