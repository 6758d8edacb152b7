#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/solve/block_matrix.h>

#include <memory>

namespace coxa::solve {

/// Direct solver for symmetric block matrices: sparse LDL^T with fill-reducing ordering, kept
/// between solves.
///
/// @note one thread; the ordering is found once per pattern and reused while the pattern stays the
/// same.
class SparseLdlt {
 public:
  SparseLdlt();
  ~SparseLdlt();
  SparseLdlt(SparseLdlt&&) noexcept;
  SparseLdlt& operator=(SparseLdlt&&) noexcept;

  /// Factors A, of which only the lower half is read; not converged where a pivot is zero or not
  /// finite.
  SolveReport factorize(const BlockMatrix& A);
  /// Pivots below zero in the factors: 0 for a positive definite matrix, > 0 for an indefinite one.
  Index negative_pivots() const;
  /// A^-1 b, for the matrix factored last, whose factorisation must have converged.
  VecX solve(const VecX& b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coxa::solve
