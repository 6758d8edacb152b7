#include <coxa/dynamics/integrators.h>

#include <coxa/core/error.h>
#include <coxa/dynamics/system.h>
#include <coxa/solve/newton.h>
#include <coxa/solve/sparse_ldlt.h>

#include <algorithm>
#include <cmath>

namespace coxa::dynamics {
namespace {

// far from equilibrium the linear solve need not be better than this (inexact Newton)
constexpr double kLoosestLinearSolve = 0.03;

/// Linear solves on the tangent at the current positions, in the allowed directions.
class Tangent {
 public:
  Tangent(Index n, const std::vector<const Force*>& forces, const Constraints& constraints,
          const RelaxOptions& options)
      : forces_(forces),
        constraints_(constraints),
        options_(options),
        A_(n, total_pattern(forces)),
        rest_(VecX::Zero(3 * Eigen::Index{n})) {}

  VecX step(const VecX& x, const VecX& residual) {
    assemble(forces_, x, rest_, 1.0, 0.0, A_);
    first_ = first_ > 0.0 ? first_ : residual.norm();
    return options_.linear_solver == LinearSolver::ldlt ? direct(residual) : iterative(residual);
  }

 private:
  VecX iterative(const VecX& residual) const {
    solve::CgOptions linear = options_.linear;
    linear.tolerance =
        std::max(linear.tolerance, std::min(kLoosestLinearSolve, residual.norm() / first_));
    VecX step = VecX::Zero(residual.size());
    const SolveReport report = solve::conjugate_gradient(
        A_, residual, step, linear, [&](VecX& values) { constraints_.filter(values); });
    // negative curvature before the first advance: follow the force, each particle by its stiffness
    if (!report.converged && step.isZero(0.0)) {
      for (Index i = 0; i < A_.n(); ++i) {
        const double stiffness =
            A_.blocks()[static_cast<std::size_t>(A_.slot(i, i))].cwiseAbs().maxCoeff();
        step.segment<3>(3 * i) = residual.segment<3>(3 * i) / (stiffness > 0.0 ? stiffness : 1.0);
      }
      constraints_.filter(step);
    }
    return step;
  }

  /// Direct solve; an indefinite tangent is shifted until it is positive definite.
  VecX direct(const VecX& residual) {
    update_constrained(constraints_, A_);
    double scale = 0.0;
    for (Index i = 0; i < A_.n(); ++i) scale = std::max(scale, std::abs(A_.at(i, i).trace()) / 3.0);
    double shift = 0.0;
    for (int attempt = 0; attempt < 40; ++attempt) {
      const SolveReport report = ldlt_.factorize(A_);
      if (report.converged && ldlt_.negative_pivots() == 0) break;
      const double more = shift > 0.0 ? shift : 1e-6 * scale;
      for (Index i = 0; i < A_.n(); ++i) A_.at(i, i).diagonal().array() += more;
      shift += more;
    }
    VecX step = ldlt_.solve(residual);
    constraints_.filter(step);
    return step;
  }

  const std::vector<const Force*>& forces_;
  const Constraints& constraints_;
  const RelaxOptions& options_;
  solve::BlockMatrix A_;
  solve::SparseLdlt ldlt_;
  VecX rest_;  // no velocity
  double first_ = 0.0;
};

}  // namespace

SolveReport update_relax(Particles& particles, const std::vector<const Force*>& forces,
                         const Constraints& constraints, const RelaxOptions& options) {
  require(options.reference_force > 0.0, "RelaxOptions::reference_force must be positive, got ",
          options.reference_force, " N");
  check(particles);
  Tangent tangent(particles.n(), forces, constraints, options);
  const VecX rest = VecX::Zero(particles.x.size());
  const solve::NewtonProblem problem{
      .residual =
          [&](const VecX& x) {
            VecX force = total_force(forces, x, rest);
            constraints.filter(force);
            return force;
          },
      .step = [&](const VecX& x, const VecX& residual) { return tangent.step(x, residual); },
      .energy = [&](const VecX& x) { return total_energy(forces, x); }};
  SolveReport report = solve::newton(problem, particles.x,
                                     {.tolerance = options.tolerance,
                                      .scale = options.reference_force,
                                      .max_iterations = options.max_iterations,
                                      .max_step = options.max_step});
  particles.v.setZero();
  return report;
}

}  // namespace coxa::dynamics
