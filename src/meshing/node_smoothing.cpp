#include "node_smoothing.h"

#include "element_shape.h"
#include "node_freedom.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::meshing {
namespace {

constexpr double kUntangleFrom = 30.0;  // shape energy from which elements count as tangled
constexpr double kLeastGain = 1e-4;     // relative fall of the energy below which a node stays

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// the three other corners, in the order that keeps the volume positive with v first
std::array<Index, 3> others(const Tet& t, Index v) {
  if (t[0] == v) return {t[1], t[2], t[3]};
  if (t[1] == v) return {t[0], t[3], t[2]};
  if (t[2] == v) return {t[0], t[1], t[3]};
  return {t[0], t[2], t[1]};
}

struct Aim {
  double power = 1.0;
  double softening = 0.0;  // mm³, of six times the volume
};

struct Star {
  std::vector<std::array<const Vec3*, 3>> faces;  // of the elements around, seen from the node

  void gather(const TetGrid& grid, Index v) {
    faces.clear();
    for (const Index t : grid.around[at(v)]) {
      const auto o = others(grid.tets[at(t)], v);
      faces.push_back({&grid.x[at(o[0])], &grid.x[at(o[1])], &grid.x[at(o[2])]});
    }
  }

  double energy(const Vec3& p, const Aim& aim, double stop) const {
    double sum = 0.0;
    for (const auto& f : faces) {
      const double e = shape_energy(p, *f[0], *f[1], *f[2], aim.softening);
      sum += aim.power == 1.0 ? e : std::pow(e, aim.power);
      if (!(sum < stop)) return kInfinity;
    }
    return sum;
  }
};

struct Model {
  double energy = 0.0;
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();
};

Model model_at(const Star& star, const Vec3& p, const Aim& aim) {
  const double power = aim.power;
  Model m;
  for (const auto& f : star.faces) {
    const ShapeDerivatives d = shape_derivatives(p, *f[0], *f[1], *f[2], aim.softening);
    if (d.energy == kInfinity) {
      m.energy = kInfinity;
      return m;
    }
    const double value = std::pow(d.energy, power), slope = power * value / d.energy;
    m.energy += value;
    m.gradient += slope * d.gradient;
    m.hessian +=
        slope * (d.hessian + (power - 1.0) / d.energy * d.gradient * d.gradient.transpose());
  }
  return m;
}

Vec3 newton_step(const Model& m, const Directions& D) {
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  using SmallVec = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
  Small H = D.transpose() * m.hessian * D;
  const SmallVec g = D.transpose() * m.gradient;
  const double scale = H.diagonal().cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return Vec3::Zero();
  // shift the curvature until it is positive: a step downhill in any case
  for (double shift = 0.0; shift < 20.0; shift = shift == 0.0 ? 0.1 : 4.0 * shift) {
    Small shifted = H;
    shifted.diagonal().array() += shift * scale;
    const Eigen::LLT<Small> factor(shifted);
    if (factor.info() == Eigen::Success) return -(D * factor.solve(g));
  }
  return -(D * g) / (20.0 * scale);
}

bool move_node(TetGrid& grid, const SlideGuide& guide, Index v, const Aim& aim, Star& star) {
  if (is_fixed(grid.kinds[at(v)]) || grid.around[at(v)].empty()) return false;
  star.gather(grid, v);
  const Vec3 p = grid.x[at(v)];
  const Model m = model_at(star, p, aim);
  if (m.energy == kInfinity) return false;
  const Vec3 step = newton_step(m, free_directions(grid, guide, v));
  const double enough = m.energy * (1.0 - kLeastGain);
  for (double share = 1.0; share > 0.1; share *= 0.5) {
    const Vec3 candidate = allowed_place(grid, guide, v, p + share * step);
    if (star.energy(candidate, aim, enough) < enough) {
      grid.x[at(v)] = candidate;
      return true;
    }
  }
  return false;
}

double energy_of(const TetGrid& grid, const Tet& t) {
  return shape_energy(grid.x[at(t[0])], grid.x[at(t[1])], grid.x[at(t[2])], grid.x[at(t[3])]);
}

// moves the corners of elements above `energy`, and `rings` of neighbours
Index move_around_bad(TetGrid& grid, const SlideGuide& guide, const Aim& aim, double energy,
                      int rings) {
  std::vector<char> wanted(grid.x.size(), 0);
  for (const Tet& t : grid.tets) {
    if (t[0] < 0 || energy_of(grid, t) <= energy) continue;
    for (const Index v : t) wanted[at(v)] = 1;
  }
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<char> before = wanted;
    for (const Tet& t : grid.tets) {
      if (t[0] < 0) continue;
      if (std::any_of(t.begin(), t.end(), [&](Index v) { return before[at(v)] != 0; })) {
        for (const Index v : t) wanted[at(v)] = 1;
      }
    }
  }
  Star star;
  Index moved = 0;
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    if (wanted[v] && move_node(grid, guide, static_cast<Index>(v), aim, star)) ++moved;
  }
  return moved;
}

}  // namespace

Index update_positions(TetGrid& grid, const SlideGuide& guide, double power) {
  Star star;
  Index moved = 0;
  for (Index v = 0; v < static_cast<Index>(grid.x.size()); ++v) {
    if (move_node(grid, guide, v, {.power = power}, star)) ++moved;
  }
  return moved;
}

Index update_worst(TetGrid& grid, const SlideGuide& guide, double power, double energy) {
  return move_around_bad(grid, guide, {.power = power}, energy, 0);
}

Index count_inverted(const TetGrid& grid) {
  return static_cast<Index>(std::count_if(grid.tets.begin(), grid.tets.end(), [&](const Tet& t) {
    return t[0] >= 0 && energy_of(grid, t) == kInfinity;
  }));
}

Index untangle(TetGrid& grid, const SlideGuide& guide) {
  constexpr int kSweeps = 60;
  double mean = 0.0;
  for (const Tet& t : grid.tets) {
    mean +=
        std::abs(volume6(grid.x[at(t[0])], grid.x[at(t[1])], grid.x[at(t[2])], grid.x[at(t[3])]));
  }
  mean /= static_cast<double>(std::max<std::size_t>(grid.tets.size(), 1));
  for (int k = 0; k < kSweeps && count_inverted(grid) > 0; ++k) {
    const double softening = 0.05 * mean * std::pow(0.9, k);
    move_around_bad(grid, guide, {.power = 1.0, .softening = softening}, kUntangleFrom, 2);
  }
  return count_inverted(grid);
}

}  // namespace coxa::meshing
