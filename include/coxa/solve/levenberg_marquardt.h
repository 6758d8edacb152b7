#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/core/types.h>

#include <functional>

namespace coxa::solve {

/// The residuals r(x) whose sum of squares is to be made small.
struct LeastSquares {
  std::function<VecX(const VecX& x)> residuals;  ///< m values, m >= 1; NaN marks an x out of bounds
  std::function<MatX(const VecX& x)> jacobian;   ///< m×n, dr/dx; empty: central differences
};

struct LmOptions {
  double tolerance = 1e-10;  ///< (0, 1): of the step to x, of the fall of the cost, of the cosine
                             ///< between residual and Jacobian columns
  int max_iterations = 100;  ///< > 0, trial steps
  double initial_damping = 1e-3;  ///< > 0, relative to the diagonal of J^T J
};

/// Minimises |r(x)|^2 from the start in `x`, which receives the result; dense, for small problems.
///
/// @returns  `residual` is |r| at the result, not relative; `iterations` counts trial steps
/// @throws Error bad_input if the residuals at the start are not finite or an option is out of
/// range Source: Marquardt 1963; damping schedule of Nielsen 1999; scaling by the largest column
/// norm met.
SolveReport levenberg_marquardt(const LeastSquares& problem, VecX& x,
                                const LmOptions& options = {});

/// dr/dx by central differences with a step of 6e-6 max(1, |x_k|).
MatX numeric_jacobian(const std::function<VecX(const VecX& x)>& residuals, const VecX& x);

}  // namespace coxa::solve
