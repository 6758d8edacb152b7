#include <coxa/solve/levenberg_marquardt.h>

#include <coxa/core/error.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace coxa::solve {
namespace {

/// Least-squares solution of [J; sqrt(damping) diag(scale)] step = [-r; 0].
VecX damped_step(const MatX& J, const VecX& r, const VecX& scale, double damping) {
  const Eigen::Index m = J.rows(), n = J.cols();
  MatX stacked(m + n, n);
  stacked << J, MatX((std::sqrt(damping) * scale).asDiagonal());
  VecX right = VecX::Zero(m + n);
  right.head(m) = -r;
  return stacked.colPivHouseholderQr().solve(right);
}

/// Largest cosine between the residual vector and a column of the Jacobian: 0 at a minimum.
double largest_cosine(const MatX& J, const VecX& r) {
  const double norm = r.norm();
  double cosine = 0.0;
  for (Eigen::Index k = 0; k < J.cols(); ++k) {
    const double length = J.col(k).norm();
    if (length > 0.0 && norm > 0.0)
      cosine = std::max(cosine, std::abs(J.col(k).dot(r)) / (length * norm));
  }
  return cosine;
}

/// Column norms of J, never smaller than `before`; 1 for a column that is zero.
VecX column_scale(const MatX& J, const VecX& before) {
  VecX scale = J.colwise().norm().transpose();
  if (before.size() == scale.size()) scale = scale.cwiseMax(before);
  return (scale.array() > 0.0).select(scale, 1.0);
}

}  // namespace

MatX numeric_jacobian(const std::function<VecX(const VecX& x)>& residuals, const VecX& x) {
  constexpr double kStep = 6e-6;  // about the cube root of the rounding unit
  MatX J;
  VecX moved = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double h = kStep * std::max(1.0, std::abs(x[k]));
    moved[k] = x[k] + h;
    const VecX above = residuals(moved);
    moved[k] = x[k] - h;
    const VecX below = residuals(moved);
    moved[k] = x[k];
    if (k == 0) J.resize(above.size(), x.size());
    J.col(k) = (above - below) / (2.0 * h);
  }
  return J;
}

SolveReport levenberg_marquardt(const LeastSquares& problem, VecX& x, const LmOptions& options) {
  require(options.tolerance > 0.0 && options.tolerance < 1.0,
          "LmOptions::tolerance must be in (0, 1), got ", options.tolerance);
  require(options.max_iterations > 0, "LmOptions::max_iterations must be positive, got ",
          options.max_iterations);
  require(options.initial_damping > 0.0, "LmOptions::initial_damping must be positive, got ",
          options.initial_damping);
  require(x.size() > 0, "levenberg_marquardt: there is no unknown");
  VecX r = problem.residuals(x);
  require(r.size() > 0 && r.allFinite(), "levenberg_marquardt: the ", r.size(),
          " residuals at the start are not all finite, or there are none");
  const auto jacobian = [&] {
    return problem.jacobian ? problem.jacobian(x) : numeric_jacobian(problem.residuals, x);
  };

  MatX J = jacobian();
  VecX scale = column_scale(J, {});
  double damping = options.initial_damping, growth = 2.0;
  SolveReport report;
  const auto finish = [&](bool converged, const std::string& reason) {
    report.converged = converged;
    report.residual = r.norm();
    report.reason = reason;
    return report;
  };
  if (largest_cosine(J, r) <= options.tolerance) return finish(true, "");
  for (report.iterations = 1; report.iterations <= options.max_iterations; ++report.iterations) {
    const VecX step = damped_step(J, r, scale, damping);
    const VecX trial = x + step;
    const VecX r_trial = problem.residuals(trial);
    const double cost = r.squaredNorm(), cost_trial = r_trial.squaredNorm();
    const double promised = cost - (r + J * step).squaredNorm();
    const bool small_step = step.norm() <= options.tolerance * (x.norm() + options.tolerance);

    if (!(cost_trial < cost)) {
      // rejected, or nothing left to gain within rounding
      if (small_step || !(promised > 1e-15 * cost)) return finish(true, "");
      damping *= growth;
      growth *= 2.0;
      if (!std::isfinite(damping)) return finish(false, "no step reduces the residual");
      continue;
    }
    // the damping shrinks by how well the linear model predicted the fall (Nielsen 1999)
    const double ratio = std::min(1.0, (cost - cost_trial) / std::max(promised, 1e-300));
    damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * ratio - 1.0, 3));
    growth = 2.0;
    const bool small_fall = cost - cost_trial <= options.tolerance * options.tolerance * cost;
    x = trial;
    r = r_trial;
    if (small_step || small_fall || cost_trial == 0.0) return finish(true, "");
    J = jacobian();
    scale = column_scale(J, scale);
    if (largest_cosine(J, r) <= options.tolerance) return finish(true, "");
  }
  report.iterations = options.max_iterations;
  return finish(false, join_text("not converged after ", options.max_iterations, " iterations"));
}

}  // namespace coxa::solve
