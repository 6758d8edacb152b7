#include <coxa/solve/newton.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <cmath>

namespace coxa::solve {
namespace {

constexpr double kArmijo = 1e-4;
constexpr double kEnergyRounding = 1e-11;  // relative; below it, energies are equal

/// One point of the search: where, its residual, and its energy (NaN without one).
struct Point {
  VecX x;
  VecX residual;
  double energy = kNaN;
};

Point evaluate(const NewtonProblem& problem, VecX x) {
  Point point{std::move(x), {}, kNaN};
  if (problem.energy) point.energy = problem.energy(point.x);
  if (point.energy != kInfinity) point.residual = problem.residual(point.x);
  return point;
}

/// Whether the trial at `share` of the step is progress; `slope` is residual . step at the start, >
/// 0.
bool is_progress(const Point& from, const Point& to, const VecX& step, double slope, double share) {
  if (to.residual.size() == 0 || !to.residual.allFinite()) return false;
  if (std::isnan(from.energy) || std::isnan(to.energy))
    return to.residual.norm() <= (1.0 - kArmijo * share) * from.residual.norm();
  if (to.energy <= from.energy - kArmijo * share * slope) return true;
  const bool same = to.energy <= from.energy + kEnergyRounding * std::abs(from.energy);
  return same && -to.residual.dot(step) <= (1.0 - 2.0 * kArmijo) * slope &&
         to.residual.norm() < from.residual.norm();
}

void check(const NewtonOptions& options) {
  require(options.tolerance > 0.0, "NewtonOptions::tolerance must be positive, got ",
          options.tolerance);
  require(options.scale > 0.0, "NewtonOptions::scale must be positive, got ", options.scale);
  require(options.max_iterations >= 0 && options.max_halvings >= 0,
          "NewtonOptions: iterations and halvings must not be negative");
  require(options.max_step >= 0.0, "NewtonOptions::max_step must not be negative, got ",
          options.max_step);
}

}  // namespace

SolveReport newton(const NewtonProblem& problem, VecX& x, const NewtonOptions& options) {
  check(options);
  SolveReport report;
  Point current = evaluate(problem, x);
  const auto finish = [&](const std::string& reason) {
    report.reason = reason;
    return report;
  };
  if (current.residual.size() == 0) {
    report.residual = kInfinity;
    return finish("the energy is infinite at the start");
  }
  while (true) {
    report.residual = current.residual.norm() / options.scale;
    report.converged = report.residual <= options.tolerance;
    if (report.converged) return report;
    if (std::isnan(report.residual)) return finish("the residual is not a number");
    if (report.iterations >= options.max_iterations)
      return finish(join_text("residual ", report.residual, " after ", options.max_iterations,
                              " Newton iterations, tolerance ", options.tolerance));

    VecX step = problem.step(current.x, current.residual);
    const double longest = step.size() > 0 ? step.cwiseAbs().maxCoeff() : 0.0;
    if (options.max_step > 0.0 && longest > options.max_step) step *= options.max_step / longest;
    const double slope = current.residual.dot(step);
    if (!std::isnan(current.energy) && !(slope > 0.0))
      return finish("the linear solve gave no direction of descent");

    double share = 1.0;
    Point trial = evaluate(problem, current.x + step);
    for (int halving = 0; !is_progress(current, trial, step, slope, share); ++halving) {
      if (halving == options.max_halvings)
        return finish(join_text("line search found no progress at residual ", report.residual));
      share *= 0.5;
      trial = evaluate(problem, current.x + share * step);
    }
    current = std::move(trial);
    x = current.x;
    ++report.iterations;
  }
}

}  // namespace coxa::solve
