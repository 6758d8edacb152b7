#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/dynamics/particles.h>
#include <coxa/solve/conjugate_gradient.h>

namespace coxa::dynamics {

enum class Integrator { backward_euler, implicit_midpoint, bdf2, runge_kutta4 };

struct StepOptions {
  Integrator integrator = Integrator::backward_euler;
  double time_step = 1e-3;       ///< s, > 0
  int newton_iterations = 1;     ///< >= 1; 1 is the linearised step of Baraff and Witkin
  double newton_tolerance = 1e-8;  ///< of the residual relative to its start
  solve::CgOptions linear;
};

/// Advances particles under forces, holding its matrix pattern and the history that BDF2 needs.
///
/// @note keeps references to the forces, which must outlive it.
class Stepper {
 public:
  Stepper(Index n_particles, std::vector<const Force*> forces);
  /// One step of `options.time_step`; particles are changed in place.
  SolveReport update_step(Particles& particles, const Constraints& constraints, const StepOptions& options);

 private:
  std::vector<const Force*> forces_;
  solve::BlockMatrix matrix_;
  VecX previous_x_, previous_v_;  ///< one step back, for BDF2; empty at the start
};

struct RelaxOptions {
  double tolerance = 1e-6;    ///< of the filtered residual relative to `reference_force`
  double reference_force = 1.0;  ///< N, > 0
  int max_iterations = 100;
  solve::CgOptions linear;
};

/// Moves the particles to static equilibrium: Newton with line search on the energy (on the residual where a
/// force has no energy). Never throws for failure to converge; the report says why.
SolveReport update_relax(Particles& particles, const std::vector<const Force*>& forces,
                         const Constraints& constraints, const RelaxOptions& options);

}  // namespace coxa::dynamics
