#pragma once

#include <coxa/core/types.h>

#include <algorithm>
#include <utility>

namespace coxa::joint {

/// Aitken's dynamic relaxation of a fixed-point iteration x <- G(x): pairs found at x are frozen
/// while G settles the forces, and a head that slides easily would otherwise overshoot for ever.
/// Source: Küttler and Wall 2008, equation 44.
class Relaxation {
 public:
  VecX next(const VecX& x, const VecX& G) {
    VecX way = G - x;
    if (way_.size() > 0) {
      const VecX change = way - way_;
      const double squared = change.squaredNorm();
      if (squared > 0.0) share_ = std::clamp(-share_ * way_.dot(change) / squared, kLeast, 1.0);
    }
    way_ = std::move(way);
    return x + share_ * way_;
  }

 private:
  static constexpr double kLeast = 0.1;
  VecX way_;
  double share_ = 1.0;
};

/// Tells when rounds of contact search lead nowhere: for a while neither the residual nor the
/// penetration has come clearly below what it was before.
class Progress {
 public:
  bool stalled(double residual, double penetration) {
    const bool forces = improves(residual, residual_), gaps = improves(penetration, penetration_);
    waiting_ = forces || gaps ? 0 : waiting_ + 1;
    return waiting_ > kPatience;
  }
  /// New multipliers raise the residual for a while.
  void multipliers_changed() { residual_ = kInfinity; }

 private:
  static constexpr int kPatience = 6;
  static constexpr double kClearly = 0.8;
  /// Against the last mark, so that many small steps count as well as one large.
  static bool improves(double value, double& mark) {
    if (!(value < kClearly * mark)) return false;
    mark = value;
    return true;
  }
  double residual_ = kInfinity, penetration_ = kInfinity;
  int waiting_ = 0;
};

}  // namespace coxa::joint
