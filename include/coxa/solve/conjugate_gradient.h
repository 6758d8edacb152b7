#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/solve/block_matrix.h>

#include <functional>

namespace coxa::solve {

struct CgOptions {
  double tolerance = 1e-8;    ///< of |r| / |b|, in (0, 1)
  int max_iterations = 2000;  ///< > 0
};

/// Solves A x = b for symmetric positive definite A by preconditioned conjugate gradients (3×3
/// block Jacobi).
///
/// `filter` projects every residual and search direction onto the directions that may move (Baraff
/// and Witkin 1998, constraints by mass modification); empty means all may. `x` holds the start and
/// receives the result. On a direction of non-positive curvature the solve stops there, keeps the x
/// reached and says so in `reason`.
SolveReport conjugate_gradient(const BlockMatrix& A, const VecX& b, VecX& x,
                               const CgOptions& options = {},
                               const std::function<void(VecX&)>& filter = {});

}  // namespace coxa::solve
