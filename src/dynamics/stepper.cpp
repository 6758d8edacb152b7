#include <coxa/dynamics/integrators.h>

#include <coxa/core/error.h>
#include <coxa/dynamics/system.h>

#include <algorithm>
#include <cmath>

namespace coxa::dynamics {
namespace {

/// An implicit step in its velocity change dv: forces act at x = base + c_x dv, velocity v + c_v
/// dv, and M dv = known + weight f. The new position is then place + c_place dv.
struct Scheme {
  VecX base;
  double c_x, c_v, weight;
  VecX known;  // 3n, N·s; empty for zero
  VecX place;
  double c_place;
};

Scheme backward_euler(const Particles& p, double h) {
  VecX end = p.x + h * p.v;
  return {end, h, 1.0, h, {}, end, h};
}

/// Implicit midpoint (Volino and Magnenat-Thalmann 2005).
Scheme implicit_midpoint(const Particles& p, double h) {
  return {p.x + 0.5 * h * p.v, 0.25 * h, 0.5, h, {}, p.x + h * p.v, 0.5 * h};
}

VecX times_mass(const Particles& p, const VecX& values) {
  VecX result(values.size());
  for (Index i = 0; i < p.n(); ++i) result.segment<3>(3 * i) = p.mass[i] * values.segment<3>(3 * i);
  return result;
}

/// BDF2 for steps h after h / ratio.
Scheme bdf2(const Particles& p, const VecX& previous_x, const VecX& previous_v, double h,
            double ratio) {
  const double past = ratio * ratio / (1.0 + 2.0 * ratio);
  const double beta = h * (1.0 + ratio) / (1.0 + 2.0 * ratio);
  VecX end = p.x + past * (p.x - previous_x) + beta * p.v;
  return {end, beta, 1.0, beta, times_mass(p, past * (p.v - previous_v)), end, beta};
}

void add_mass(const Particles& p, solve::BlockMatrix& A) {
  for (Index i = 0; i < p.n(); ++i) A.at(i, i).diagonal().array() += p.mass[i];
}

/// The prescribed velocity changes in the forbidden directions, zero elsewhere.
VecX prescribed_change(const Constraints& constraints, Eigen::Index size) {
  VecX change = VecX::Zero(size);
  for (std::size_t k = 0; k < constraints.particles.size(); ++k)
    change.segment<3>(3 * Eigen::Index{constraints.particles[k]}) =
        (Mat3::Identity() - constraints.allowed[k]) * constraints.velocity_change[k];
  return change;
}

void check(const Particles& particles, const Constraints& constraints, const StepOptions& options,
           Index n) {
  require(particles.n() == n, "the stepper was made for ", n, " particles, got ", particles.n());
  check(particles);
  require(constraints.particles.empty() || constraints.particles.back() < n,
          "a constraint names particle ",
          constraints.particles.empty() ? 0 : constraints.particles.back(), " of ", n);
  require(options.time_step > 0.0, "StepOptions::time_step must be positive, got ",
          options.time_step, " s");
  require(options.newton_iterations >= 1, "StepOptions::newton_iterations must be at least 1, got ",
          options.newton_iterations);
  require(options.newton_tolerance > 0.0, "StepOptions::newton_tolerance must be positive, got ",
          options.newton_tolerance);
}

/// Names the first particle whose position is not finite.
std::string place_of_failure(const VecX& x) {
  for (Eigen::Index k = 0; k < x.size(); ++k)
    if (!std::isfinite(x[k])) return join_text("particle ", k / 3, " is at no finite position");
  return {};
}

}  // namespace

Stepper::Stepper(Index n_particles, std::vector<const Force*> forces)
    : forces_(std::move(forces)), matrix_(n_particles, total_pattern(forces_)) {}

void Stepper::update_pattern() {
  matrix_ = solve::BlockMatrix(matrix_.n(), total_pattern(forces_));
}

void Stepper::forget_history() { previous_x_.resize(0); }

namespace {

/// What one solve needs to know.
struct Step {
  const std::vector<const Force*>& forces;
  const Particles& particles;
  const Constraints& constraints;
  const StepOptions& options;
  const Scheme& scheme;
};

/// Solves for the first change dv with forces linearised at (x, v) (Baraff and Witkin 1998).
SolveReport linearised_solve(const Step& s, solve::BlockMatrix& A, VecX& dv, VecX& right) {
  const auto& [x, v, mass] = s.particles;
  const double stiffness = s.scheme.weight * s.scheme.c_x;

  // stiffness alone first: its product with the known part of the motion enters the right side
  right = s.scheme.weight * total_force(s.forces, x, v);
  assemble(s.forces, x, v, stiffness, 0.0, A);
  VecX pull;
  A.multiply(s.scheme.base - x, pull);
  right -= pull / s.scheme.c_x;
  if (s.scheme.known.size() > 0) right += s.scheme.known;

  for (const Force* force : s.forces)
    force->add_jacobian(x, v, 0.0, s.scheme.weight * s.scheme.c_v, A);
  add_mass(s.particles, A);
  return solve::conjugate_gradient(A, right, dv, s.options.linear,
                                   [&](VecX& values) { s.constraints.filter(values); });
}

/// What the step's equation leaves unbalanced at dv, in the allowed directions.
VecX imbalance(const Step& s, const VecX& dv) {
  VecX rest = s.scheme.weight * total_force(s.forces, s.scheme.base + s.scheme.c_x * dv,
                                            s.particles.v + s.scheme.c_v * dv) -
              times_mass(s.particles, dv);
  if (s.scheme.known.size() > 0) rest += s.scheme.known;
  s.constraints.filter(rest);
  return rest;
}

/// Newton's method on the step's full equation, after the linearised first iteration.
SolveReport nonlinear_solve(const Step& s, solve::BlockMatrix& A, VecX& dv, VecX& right) {
  linearised_solve(s, A, dv, right);
  s.constraints.filter(right);
  const double start = right.norm();
  SolveReport report;
  for (report.iterations = 1;; ++report.iterations) {
    const VecX rest = imbalance(s, dv);
    report.residual = start > 0.0 ? rest.norm() / start : rest.norm();
    report.converged = report.residual <= s.options.newton_tolerance;
    if (report.converged) return report;
    if (report.iterations >= s.options.newton_iterations || std::isnan(report.residual)) {
      report.reason = join_text("residual ", report.residual, " after ", report.iterations,
                                " Newton iterations, tolerance ", s.options.newton_tolerance);
      return report;
    }
    const VecX x = s.scheme.base + s.scheme.c_x * dv, v = s.particles.v + s.scheme.c_v * dv;
    assemble(s.forces, x, v, s.scheme.weight * s.scheme.c_x, s.scheme.weight * s.scheme.c_v, A);
    add_mass(s.particles, A);
    VecX correction = VecX::Zero(dv.size());
    solve::conjugate_gradient(A, rest, correction, s.options.linear,
                              [&](VecX& values) { s.constraints.filter(values); });
    dv += correction;
  }
}

/// Classical Runge-Kutta; prescribed changes are spread evenly over the step.
SolveReport runge_kutta4_step(const std::vector<const Force*>& forces, Particles& p,
                              const Constraints& constraints, double h) {
  const VecX prescribed = prescribed_change(constraints, p.x.size()) / h;
  const auto acceleration = [&](const VecX& x, const VecX& v) {
    VecX a = total_force(forces, x, v);
    for (Index i = 0; i < p.n(); ++i) a.segment<3>(3 * i) /= p.mass[i];
    constraints.filter(a);
    return VecX(a + prescribed);
  };
  const VecX &x = p.x, &v = p.v;
  const VecX a1 = acceleration(x, v);
  const VecX v2 = v + 0.5 * h * a1, a2 = acceleration(x + 0.5 * h * v, v2);
  const VecX v3 = v + 0.5 * h * a2, a3 = acceleration(x + 0.5 * h * v2, v3);
  const VecX v4 = v + h * a3, a4 = acceleration(x + h * v3, v4);
  p.x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
  p.v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  return {.converged = true, .iterations = 1, .residual = 0.0, .reason = {}};
}

}  // namespace

SolveReport Stepper::update_step(Particles& particles, const Constraints& constraints,
                                 const StepOptions& options) {
  check(particles, constraints, options, matrix_.n());
  const double h = options.time_step;
  const VecX x_before = particles.x, v_before = particles.v;

  SolveReport report;
  if (options.integrator == Integrator::runge_kutta4) {
    report = runge_kutta4_step(forces_, particles, constraints, h);
  } else {
    const bool has_history = previous_x_.size() == particles.x.size();
    const Scheme scheme = options.integrator == Integrator::backward_euler
                              ? backward_euler(particles, h)
                          : options.integrator == Integrator::bdf2 && has_history
                              ? bdf2(particles, previous_x_, previous_v_, h, h / previous_step_)
                              : implicit_midpoint(particles, h);  // BDF2 starts with it too
    const Step step{forces_, particles, constraints, options, scheme};
    VecX dv = prescribed_change(constraints, particles.x.size()), right;
    report = options.newton_iterations == 1 ? linearised_solve(step, matrix_, dv, right)
                                            : nonlinear_solve(step, matrix_, dv, right);
    particles.x = scheme.place + scheme.c_place * dv;
    particles.v += dv;
  }
  const std::string failure = place_of_failure(particles.x);
  if (!failure.empty()) {
    report.converged = false;
    report.reason = failure;
  }
  previous_x_ = x_before;
  previous_v_ = v_before;
  previous_step_ = h;
  return report;
}

}  // namespace coxa::dynamics
