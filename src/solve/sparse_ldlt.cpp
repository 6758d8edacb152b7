#include <coxa/solve/sparse_ldlt.h>

#include <coxa/core/error.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace coxa::solve {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// The lower half of A. Row i of blocks becomes columns 3i..3i+2 of the transpose, which is A
/// again.
Sparse lower_half(const BlockMatrix& A) {
  Sparse lower(3 * A.n(), 3 * A.n());
  Eigen::VectorXi count(3 * A.n());
  const auto first = [&](Index i) { return A.row_start()[static_cast<std::size_t>(i)]; };
  for (Index i = 0; i < A.n(); ++i) {
    const auto upper = first(i + 1) - A.slot(i, i);
    for (int k = 0; k < 3; ++k) count[3 * i + k] = static_cast<int>(3 * upper - k);
  }
  lower.reserve(count);
  for (Index i = 0; i < A.n(); ++i)
    for (int k = 0; k < 3; ++k)
      for (auto slot = A.slot(i, i); slot < first(i + 1); ++slot) {
        const Index j = A.columns()[static_cast<std::size_t>(slot)];
        for (int l = i == j ? k : 0; l < 3; ++l)
          lower.insert(3 * j + l, 3 * i + k) = A.blocks()[static_cast<std::size_t>(slot)](k, l);
      }
  lower.makeCompressed();
  return lower;
}

}  // namespace

struct SparseLdlt::Impl {
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower> solver;
  std::vector<Index> columns;  // the pattern analysed
  std::vector<std::int64_t> row_start;
  bool factored = false;
};

SparseLdlt::SparseLdlt() : impl_(std::make_unique<Impl>()) {}
SparseLdlt::~SparseLdlt() = default;
SparseLdlt::SparseLdlt(SparseLdlt&&) noexcept = default;
SparseLdlt& SparseLdlt::operator=(SparseLdlt&&) noexcept = default;

SolveReport SparseLdlt::factorize(const BlockMatrix& A) {
  const Sparse lower = lower_half(A);
  if (impl_->columns != A.columns() || impl_->row_start != A.row_start()) {
    impl_->solver.analyzePattern(lower);
    impl_->columns = A.columns();
    impl_->row_start = A.row_start();
  }
  impl_->solver.factorize(lower);
  impl_->factored = impl_->solver.info() == Eigen::Success && impl_->solver.vectorD().allFinite();
  SolveReport report;
  report.converged = impl_->factored;
  if (!report.converged) report.reason = "a pivot of the matrix is zero or not finite";
  return report;
}

Index SparseLdlt::negative_pivots() const {
  COXA_ASSERT(impl_->factored);
  return static_cast<Index>((impl_->solver.vectorD().array() < 0.0).count());
}

VecX SparseLdlt::solve(const VecX& b) const {
  COXA_ASSERT(impl_->factored);
  require(b.size() == impl_->solver.cols(), "SparseLdlt::solve: the matrix has ",
          impl_->solver.cols(), " rows, b has ", b.size());
  return impl_->solver.solve(b);
}

}  // namespace coxa::solve
