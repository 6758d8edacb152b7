#pragma once

#include <coxa/dynamics/particles.h>

namespace coxa::dynamics {

/// The same force whatever the positions: weight, or a dead load.
class ConstantForce : public Force {
 public:
  /// @param force 3n values, N
  explicit ConstantForce(VecX force) : force_(std::move(force)) {}
  std::vector<std::pair<Index, Index>> pattern() const override { return {}; }
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX&, const VecX&, double, double, solve::BlockMatrix&) const override {}
  double energy(const VecX& x) const override;

 private:
  VecX force_;
};

/// Pulls back to its rest length along its line; energy stiffness (l - rest)^2 / 2.
struct Spring {
  Index a = 0, b = 0;        ///< particles
  double rest_length = 0.0;  ///< mm, >= 0
  double stiffness = 0.0;    ///< N/mm, >= 0
  double damping = 0.0;      ///< N·s/mm along the line, >= 0
  enum class Mode { both_ways, tension_only } mode = Mode::both_ways;
};

/// Springs between particles: links, and ligaments in mode `tension_only`.
class SpringForce : public Force {
 public:
  /// @throws Error bad_input for a spring of a particle with itself, or a negative value
  explicit SpringForce(std::vector<Spring> springs);
  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;
  /// Force along spring k at x, N, positive in tension, without its damping.
  double tension(std::size_t k, const VecX& x) const;

 private:
  std::vector<Spring> springs_;
};

/// Damping by the velocity of each particle: f = -coefficient m v.
class MassDamping : public Force {
 public:
  /// @param mass n values, tonne   @param coefficient 1/s, >= 0
  MassDamping(VecX mass, double coefficient);
  std::vector<std::pair<Index, Index>> pattern() const override { return {}; }
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX&) const override { return 0.0; }

 private:
  VecX mass_;
  double coefficient_;
};

}  // namespace coxa::dynamics
