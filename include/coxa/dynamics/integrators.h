#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/dynamics/particles.h>
#include <coxa/solve/conjugate_gradient.h>

namespace coxa::dynamics {

enum class Integrator { backward_euler, implicit_midpoint, bdf2, runge_kutta4 };

struct StepOptions {
  Integrator integrator = Integrator::backward_euler;
  double time_step = 1e-3;         ///< s, > 0
  int newton_iterations = 1;       ///< >= 1; 1 is the linearised step of Baraff and Witkin
  double newton_tolerance = 1e-8;  ///< of the residual relative to its start
  solve::CgOptions linear = {};
};

/// Advances particles under forces, holding its matrix pattern and the history that BDF2 needs.
///
/// BDF2 follows changes of the time step and starts with an implicit midpoint step. With
/// Runge-Kutta 4 the prescribed velocity changes are spread over the step.
/// @note keeps references to the forces, which must outlive it; bit-identical for any number of
/// threads.
class Stepper {
 public:
  Stepper(Index n_particles, std::vector<const Force*> forces);
  /// One step of `options.time_step`; particles are changed in place.
  ///
  /// Not converged where the linear solve (or with several Newton iterations, Newton's method)
  /// misses its tolerance, or where a particle is at no finite position.
  SolveReport update_step(Particles& particles, const Constraints& constraints,
                          const StepOptions& options);
  /// Asks the forces for their pattern anew, after one has changed (contact pairs).
  void update_pattern();
  /// Lets the next BDF2 step start afresh, after particles were moved by other means.
  void forget_history();

 private:
  std::vector<const Force*> forces_;
  solve::BlockMatrix matrix_;
  VecX previous_x_, previous_v_;  ///< one step back, for BDF2; empty at the start
  double previous_step_ = 0.0;    // s
};

enum class LinearSolver {
  conjugate_gradient,  ///< several threads, little memory; slow for thin, nearly incompressible
                       ///< bodies
  ldlt                 ///< sparse direct, one thread; sure
};

struct RelaxOptions {
  double tolerance = 1e-6;       ///< of the filtered residual relative to `reference_force`
  double reference_force = 1.0;  ///< N, > 0
  int max_iterations = 100;
  double max_step = 0.0;  ///< mm, longest change of a coordinate in one iteration; 0: no limit
  LinearSolver linear_solver = LinearSolver::conjugate_gradient;
  solve::CgOptions linear = {};  ///< tightest; far from equilibrium the linear solves are looser
};

/// Moves the particles to static equilibrium: Newton with line search on the energy (on the
/// residual where a force has no energy). Never throws for failure to converge; the report says
/// why.
///
/// Constraints hold particles where they are (their velocity changes play no part here: move the
/// particles first); the velocities are zero afterwards.
/// @returns  `residual` is the norm of the filtered force over `reference_force`
SolveReport update_relax(Particles& particles, const std::vector<const Force*>& forces,
                         const Constraints& constraints, const RelaxOptions& options);

}  // namespace coxa::dynamics
