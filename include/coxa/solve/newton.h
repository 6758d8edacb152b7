#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/core/types.h>

#include <functional>

namespace coxa::solve {

/// r(x) = 0 to be solved; where r is minus the gradient of an energy, the energy guides the search.
struct NewtonProblem {
  std::function<VecX(const VecX& x)> residual;
  /// The increment that a linear solve at x proposes for this residual.
  std::function<VecX(const VecX& x, const VecX& residual)> step;
  std::function<double(const VecX& x)>
      energy;  ///< empty or NaN: search on |r|; infinite: x forbidden
};

struct NewtonOptions {
  double tolerance = 1e-8;  ///< > 0, on |r| / scale
  double scale = 1.0;       ///< > 0, the size of |r| that counts as 1
  int max_iterations = 50;  ///< >= 0
  int max_halvings = 30;    ///< >= 0, of one step
  double max_step = 0.0;    ///< longest change of one value in one iteration; 0: no limit
};

/// Newton's method with a backtracking line search, from the start in `x`, which receives the
/// result.
///
/// The step is halved until the energy falls by Armijo's rule (near the minimum, where energies
/// differ only by rounding, until the slope has fallen: Hager and Zhang 2005); without energy,
/// until |r| falls.
/// @returns  `residual` is |r| / scale; never throws for failure to converge
SolveReport newton(const NewtonProblem& problem, VecX& x, const NewtonOptions& options = {});

}  // namespace coxa::solve
