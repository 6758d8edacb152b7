#include <coxa/fem/flow_stepper.h>

#include <coxa/core/error.h>
#include <coxa/dynamics/system.h>
#include <coxa/solve/newton.h>

namespace coxa::fem {

FlowStepper::FlowStepper(PoreFluid& fluid, std::vector<const dynamics::Force*> solid, VecX x)
    : fluid_(fluid), forces_(std::move(solid)), start_(std::move(x)) {
  require(start_.size() == 3 * Eigen::Index{fluid.n_particles()}, "the fluid has ",
          fluid.n_particles(), " particles, the start ", start_.size(), " coordinates");
  forces_.push_back(&fluid_);
  matrix_ = solve::BlockMatrix(fluid.n_particles(), dynamics::total_pattern(forces_));
}

SolveReport FlowStepper::update_step(VecX& x, const dynamics::Constraints& constraints,
                                     const FlowStepOptions& options) {
  const double h = options.time_step;
  require(x.size() == start_.size(), "the step ends with ", x.size(),
          " coordinates, it starts with ", start_.size());
  fluid_.begin_step(start_, h);
  const auto velocity = [&](const VecX& at) -> VecX { return (at - start_) / h; };
  const solve::NewtonProblem problem{
      .residual =
          [&](const VecX& at) {
            VecX force = dynamics::total_force(forces_, at, velocity(at));
            constraints.filter(force);
            return force;
          },
      .step =
          [&](const VecX& at, const VecX& residual) {
            dynamics::assemble(forces_, at, velocity(at), 1.0, 1.0 / h, matrix_);
            dynamics::update_constrained(constraints, matrix_);
            if (!solver_.factorize(matrix_).converged) return VecX(VecX::Zero(at.size()));
            VecX step = solver_.solve(residual);
            constraints.filter(step);
            return step;
          },
      .energy = {}};
  const SolveReport report = solve::newton(problem, x,
                                           {.tolerance = options.tolerance,
                                            .scale = options.reference_force,
                                            .max_iterations = options.max_iterations});
  if (report.converged) {
    start_ = x;
    time_ += h;
  }
  return report;
}

}  // namespace coxa::fem
