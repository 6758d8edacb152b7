#include "flips.h"

#include "element_shape.h"
#include "flip_guard.h"
#include "grid_topology.h"

#include <algorithm>
#include <array>
#include <vector>

namespace coxa::meshing {
namespace {

constexpr double kLeastGain = 1e-3;
constexpr std::size_t kLargestRing = 8;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double quality(const TetGrid& grid, Index a, Index b, Index c, Index d) {
  return flip_quality(grid, {a, b, c, d});
}

double worst_of(const TetGrid& grid, const std::vector<Index>& tets) {
  double worst = kInfinity;
  for (const Index t : tets) worst = std::min(worst, flip_quality(grid, grid.tets[at(t)]));
  return worst;
}

// best triangulation of the ring around an edge, by the worst element above and below it
class RingFilling {
 public:
  RingFilling(const TetGrid& grid, Index a, Index b, const std::vector<Index>& ring)
      : grid_(grid), a_(a), b_(b), ring_(ring) {
    const std::size_t n = ring.size();
    for (auto& row : best_) row.fill(kInfinity);
    for (std::size_t width = 2; width < n; ++width)
      for (std::size_t i = 0; i + width < n; ++i) {
        best_[i][i + width] = -1.0;
        for (std::size_t k = i + 1; k < i + width; ++k) try_split(i, k, i + width);
      }
  }
  double worst() const { return best_[0][ring_.size() - 1]; }
  std::vector<Tet> tets() const {
    std::vector<Tet> made;
    collect(0, ring_.size() - 1, made);
    return made;
  }

 private:
  void try_split(std::size_t i, std::size_t k, std::size_t j) {
    const double rest = std::min(best_[i][k], best_[k][j]);
    if (rest <= best_[i][j]) return;
    const Index p = ring_[i], q = ring_[k], r = ring_[j];
    const double value = std::min({rest, quality(grid_, p, q, r, b_), quality(grid_, p, r, q, a_)});
    if (value <= best_[i][j]) return;
    best_[i][j] = value;
    split_[i][j] = k;
  }
  void collect(std::size_t i, std::size_t j, std::vector<Tet>& made) const {
    if (j < i + 2) return;
    const std::size_t k = split_[i][j];
    made.push_back({ring_[i], ring_[k], ring_[j], b_});
    made.push_back({ring_[i], ring_[j], ring_[k], a_});
    collect(i, k, made);
    collect(k, j, made);
  }

  const TetGrid& grid_;
  Index a_, b_;
  const std::vector<Index>& ring_;
  std::array<std::array<double, kLargestRing>, kLargestRing> best_{};
  std::array<std::array<std::size_t, kLargestRing>, kLargestRing> split_{};
};

// A grid whose connections change, and how many elements more it may get.
struct Flipping {
  TetGrid& grid;
  const FlipGuard& guard;
  std::ptrdiff_t room;

  bool replace(const std::vector<Index>& old, const std::vector<Tet>& made) {
    const auto more =
        static_cast<std::ptrdiff_t>(made.size()) - static_cast<std::ptrdiff_t>(old.size());
    if (more > room) return false;
    room -= more;
    for (const Index t : old) grid.remove(t);
    for (const Tet& t : made) grid.add(t);
    return true;
  }
};

// Whether an edge or a face that the new elements bring is there already, away from the ring: where
// the boundary folds over itself.
bool repeats(const TetGrid& grid, const EdgeRing& ring, const std::vector<Tet>& made) {
  const auto& r = ring.corners;
  const auto beside = [&](Index p, Index q) {
    for (std::size_t k = 0; k + (ring.closed ? 0 : 1) < r.size(); ++k) {
      const Index a = r[k], b = r[(k + 1) % r.size()];
      if ((a == p && b == q) || (a == q && b == p)) return true;
    }
    return false;
  };
  for (const Tet& t : made) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!beside(t[k], t[(k + 1) % 3]) && has_edge(grid, t[k], t[(k + 1) % 3])) return true;
    if (has_face(grid, t[0], t[1], t[2])) return true;
  }
  return false;
}

bool remove_edge(Flipping& flipping, Index a, Index b) {
  const TetGrid& grid = flipping.grid;
  const EdgeRing ring = ring_around(grid, a, b);
  if (ring.corners.size() < 3 || ring.corners.size() > kLargestRing) return false;
  const double old = worst_of(grid, ring.tets);
  const RingFilling filling(grid, a, b, ring.corners);
  if (filling.worst() < old + kLeastGain) return false;
  if (!ring.closed &&
      !flipping.guard.allows_swap(grid, a, b, ring.corners.front(), ring.corners.back()))
    return false;
  if (repeats(grid, ring, filling.tets())) return false;
  return flipping.replace(ring.tets, filling.tets());
}

// two elements that share a face become three around the edge between their tips
bool remove_face(Flipping& flipping, Index t, std::size_t corner) {
  const TetGrid& grid = flipping.grid;
  const Tet tet = grid.tets[at(t)];
  const Facet f = facet_opposite(tet, corner);
  Index other = -1;
  for (const Index s : grid.around[at(f[0])])
    if (s != t && contains(grid.tets[at(s)], f[1]) && contains(grid.tets[at(s)], f[2])) other = s;
  if (other < 0) return false;
  const Tet& far = grid.tets[at(other)];
  Index tip = -1;
  for (const Index v : far)
    if (v != f[0] && v != f[1] && v != f[2]) tip = v;
  const double old = worst_of(grid, {t, other});
  std::vector<Tet> made;
  for (std::size_t k = 0; k < 3; ++k) {
    // f runs counter-clockwise seen from the other tip
    made.push_back({tet[corner], f[k], f[(k + 1) % 3], tip});
    if (flip_quality(grid, made.back()) < old + kLeastGain) return false;
  }
  if (has_edge(grid, tet[corner], tip)) return false;
  return flipping.replace({t, other}, made);
}

// the elements that have a or b, with a in place of b
bool collapse_edge(Flipping& flipping, Index a, Index b) {
  const TetGrid& grid = flipping.grid;
  std::vector<Index> old;
  std::vector<Tet> made;
  double before = kInfinity;
  for (const Index t : grid.around[at(b)]) {
    old.push_back(t);
    before = std::min(before, flip_quality(grid, grid.tets[at(t)]));
  }
  for (const Index t : old) {
    Tet moved = grid.tets[at(t)];
    if (contains(moved, a)) continue;
    std::replace(moved.begin(), moved.end(), b, a);
    if (flip_quality(grid, moved) < before + kLeastGain) return false;
    made.push_back(moved);
  }
  if (made.empty() || !flipping.guard.allows_collapse(grid, a, b)) return false;
  return flipping.replace(old, made);
}

// takes a flat element at the boundary away: two of its facets are there, and the others take
// their place
bool peel(Flipping& flipping, Index t) {
  constexpr double kFlat = 0.3;  // quality
  const TetGrid& grid = flipping.grid;
  const Tet tet = grid.tets[at(t)];
  if (flip_quality(grid, tet) > kFlat) return false;
  std::vector<Index> outer, shared;  // corners opposite to facets of the boundary, and the others
  for (std::size_t k = 0; k < 4; ++k)
    (on_boundary(grid, facet_opposite(tet, k)) ? outer : shared).push_back(tet[k]);
  if (outer.size() != 2 ||
      !flipping.guard.allows_peeling(grid, shared[0], shared[1], outer[0], outer[1]))
    return false;
  return flipping.replace({t}, {});
}

bool improve_around(Flipping& flipping, Index t, bool collapse) {
  const Tet tet = flipping.grid.tets[at(t)];
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      if (remove_edge(flipping, tet[i], tet[j])) return true;
  for (std::size_t k = 0; k < 4; ++k)
    if (remove_face(flipping, t, k)) return true;
  for (std::size_t i = 0; i < 4 && collapse; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      if (i != j && collapse_edge(flipping, tet[i], tet[j])) return true;
  return peel(flipping, t);
}

}  // namespace

double flip_quality(const TetGrid& grid, const Tet& t) {
  return 1.0 / shape_energy(grid.x[at(t[0])], grid.x[at(t[1])], grid.x[at(t[2])], grid.x[at(t[3])]);
}

Index flip_poor(TetGrid& grid, const SlideGuide& guide, const FlipRules& rules) {
  constexpr int kPasses = 4;
  const FlipGuard guard(guide, rules.tolerance, rules.at_creases);
  Flipping flipping{grid, guard, rules.max_tets - grid.n_living()};
  Index changes = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<std::pair<double, Index>> poor;
    for (std::size_t t = 0; t < grid.tets.size(); ++t) {
      if (grid.tets[t][0] < 0) continue;
      const double q = flip_quality(grid, grid.tets[t]);
      if (q < rules.below) poor.emplace_back(q, static_cast<Index>(t));
    }
    std::sort(poor.begin(), poor.end());
    Index made = 0;
    for (const auto& [q, t] : poor)
      if (grid.alive(t) && improve_around(flipping, t, rules.collapse)) ++made;
    changes += made;
    if (made == 0) break;
  }
  return changes;
}

}  // namespace coxa::meshing
