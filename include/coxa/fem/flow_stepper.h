#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/fem/pore_fluid.h>
#include <coxa/solve/sparse_ldlt.h>

namespace coxa::fem {

struct FlowStepOptions {
  double time_step = 1.0;        ///< s, > 0
  double tolerance = 1e-8;       ///< > 0, of the filtered residual relative to `reference_force`
  double reference_force = 1.0;  ///< N, > 0
  int max_iterations = 30;       ///< > 0, of Newton's method
};

/// Takes a biphasic body through time, without inertia: backward Euler, Newton's method, direct
/// solves of the symmetric indefinite system.
/// @note keeps references to fluid and forces, which must outlive it; the direct solver uses one
/// thread
class FlowStepper {
 public:
  /// @param solid  every other force on the body; velocities that they feel are the step's means
  /// @param x      where the first step starts, 3 n_particles values of `fluid`
  FlowStepper(PoreFluid& fluid, std::vector<const dynamics::Force*> solid, VecX x);

  /// One step from where the last one ended to `x`, which holds what is prescribed at its end
  /// (positions and pressures of held particles) and a guess elsewhere, and receives the result.
  /// @returns not converged: `x` is not to be used, and the next call tries again from the same
  /// start
  SolveReport update_step(VecX& x, const dynamics::Constraints& constraints,
                          const FlowStepOptions& options);
  double time() const { return time_; }  ///< s, reached by steps that converged

 private:
  PoreFluid& fluid_;
  std::vector<const dynamics::Force*> forces_;  ///< the fluid's last
  VecX start_;
  double time_ = 0.0;
  solve::BlockMatrix matrix_;
  solve::SparseLdlt solver_;
};

}  // namespace coxa::fem
