#include "worst_elements.h"

#include "element_shape.h"
#include "node_freedom.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::meshing {
namespace {

constexpr double kSmallAngle = radians(12.5), kFlatAngle = radians(22.0), kLowAspect = 0.25;
constexpr double kFirstStep = 0.2;  // of the mean edge around the node; halved three times

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

double worst_energy(const TetGrid& grid, Index v) {
  double worst = 0.0;
  for (const Index t : grid.around[at(v)]) {
    const Tet& n = grid.tets[at(t)];
    worst = std::max(worst, shape_energy(grid.x[at(n[0])], grid.x[at(n[1])], grid.x[at(n[2])],
                                         grid.x[at(n[3])]));
  }
  return worst;
}

double draw_node(TetGrid& grid, Index v, const Vec3& place, double worst) {
  const Vec3 old = grid.x[at(v)];
  const double allowed = std::max(worst, worst_energy(grid, v));
  for (const double share : {1.0, 0.8, 0.6, 0.4, 0.2}) {
    grid.x[at(v)] = old + share * (place - old);
    if (worst_energy(grid, v) <= allowed) return share;
  }
  grid.x[at(v)] = old;
  return 0.0;
}

double element_rank(const TetGrid& grid, const Tet& t) {
  const Vec3 &a = grid.x[at(t[0])], &b = grid.x[at(t[1])], &c = grid.x[at(t[2])],
             &d = grid.x[at(t[3])];
  const double aspect = aspect_ratio(a, b, c, d);
  if (aspect <= 0.0) return 0.0;
  const DihedralRange angles = dihedral_range(a, b, c, d);
  return std::min(
      {angles.smallest / kSmallAngle, (kPi - angles.largest) / kFlatAngle, aspect / kLowAspect});
}

namespace {

double worst_around(const TetGrid& grid, Index v, double stop) {
  double worst = kInfinity;
  for (const Index t : grid.around[at(v)]) {
    worst = std::min(worst, element_rank(grid, grid.tets[at(t)]));
    if (worst <= stop) return worst;
  }
  return worst;
}

double mean_edge(const TetGrid& grid, Index v) {
  double sum = 0.0;
  for (const Index t : grid.around[at(v)]) {
    for (const Index u : grid.tets[at(t)]) sum += (grid.x[at(u)] - grid.x[at(v)]).norm();
  }
  return sum / (3.0 * static_cast<double>(grid.around[at(v)].size()));
}

// the axes and diagonals of the directions a node may slide in, both ways
std::vector<Vec3> trial_directions(const TetGrid& grid, const SlideGuide& guide, Index v) {
  const Directions axes = free_directions(grid, guide, v);
  std::vector<Vec3> trials;
  const std::array<int, 3> signs{0, 1, -1};
  const auto sign_range = [&](Eigen::Index axis) { return axis < axes.cols() ? 3U : 1U; };
  for (std::size_t i = 0; i < sign_range(0); ++i) {
    for (std::size_t j = 0; j < sign_range(1); ++j) {
      for (std::size_t k = 0; k < sign_range(2); ++k) {
        Vec3 d = Vec3::Zero();
        if (axes.cols() > 0) d += signs[i] * axes.col(0);
        if (axes.cols() > 1) d += signs[j] * axes.col(1);
        if (axes.cols() > 2) d += signs[k] * axes.col(2);
        if (d.norm() > 0.5) trials.push_back(d.normalized());
      }
    }
  }
  return trials;
}

bool raise_node(TetGrid& grid, const SlideGuide& guide, Index v) {
  if (is_fixed(grid.kinds[at(v)])) return false;
  double best = worst_around(grid, v, 0.0);
  const double before = best;
  double step = kFirstStep * mean_edge(grid, v);
  for (int level = 0; level < 4; ++level, step *= 0.5) {
    const Vec3 centre = grid.x[at(v)];
    Vec3 place = centre;
    for (const Vec3& d : trial_directions(grid, guide, v)) {
      grid.x[at(v)] = allowed_place(grid, guide, v, centre + step * d);
      const double value = worst_around(grid, v, best);
      if (value > best + 1e-6) {
        best = value;
        place = grid.x[at(v)];
      }
    }
    grid.x[at(v)] = place;
  }
  return best > before;
}

}  // namespace

Index raise_worst(TetGrid& grid, const SlideGuide& guide) {
  std::vector<std::pair<double, Index>> bad;
  for (std::size_t t = 0; t < grid.tets.size(); ++t) {
    if (grid.tets[t][0] < 0) continue;
    const double r = element_rank(grid, grid.tets[t]);
    if (r < 1.0) bad.emplace_back(r, static_cast<Index>(t));
  }
  std::sort(bad.begin(), bad.end());
  Index moved = 0;
  for (const auto& [r, t] : bad) {
    for (const Index v : grid.tets[at(t)]) {
      if (raise_node(grid, guide, v)) ++moved;
    }
  }
  return moved;
}

void draw_back(TetGrid& grid, const SlideGuide& guide) {
  constexpr int kRounds = 3;
  constexpr double kGood = 1.0, kAtHome = 1e-6;  // rank; mm
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t v = 0; v < grid.x.size(); ++v) {
      if (!(grid.reach[v] > 0.0) || grid.around[v].empty()) continue;
      const Vec3 old = grid.x[v], home = guide.place(grid.kinds[v], old);
      if ((home - old).norm() < kAtHome) continue;
      const double wanted = std::min(kGood, worst_around(grid, static_cast<Index>(v), 0.0));
      for (const double share : {1.0, 0.7, 0.4, 0.2}) {
        grid.x[v] = old + share * (home - old);
        if (worst_around(grid, static_cast<Index>(v), 0.0) >= wanted) break;
        grid.x[v] = old;
      }
    }
  }
}

}  // namespace coxa::meshing
