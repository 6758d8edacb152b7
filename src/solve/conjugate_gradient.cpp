#include <coxa/solve/conjugate_gradient.h>

#include <coxa/core/error.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

#include "rows.h"

namespace coxa::solve {
namespace {

/// The vectors of one solve, and sums over them in a fixed order.
class Workspace {
 public:
  Workspace(const BlockMatrix& A, VecX& x) : A_(A), x_(x), n_(A.n()) {
    r.resize(x.size());
    p.resize(x.size());
    q.resize(x.size());
    z.resize(x.size());
    invert_diagonal();
  }

  /// r = b - A x
  void start(const VecX& b) {
    sum([&](Index i, double) {
      r.segment<3>(3 * i) = b.segment<3>(3 * i) - A_.row_times(i, x_.data());
      return 0.0;
    });
  }
  /// q = A p; returns p.q
  double multiply() {
    return sum([&](Index i, double total) {
      const Vec3 y = A_.row_times(i, p.data());
      q.segment<3>(3 * i) = y;
      return total + p.segment<3>(3 * i).dot(y);
    });
  }
  double dot(const VecX& a, const VecX& b) {
    return sum([&](Index i, double total) {
      return total + a.segment<3>(3 * i).dot(b.segment<3>(3 * i));
    });
  }
  /// x += step p, r -= step q; returns r.r
  double advance(double step) {
    return sum([&](Index i, double total) {
      x_.segment<3>(3 * i) += step * p.segment<3>(3 * i);
      const Vec3 rest = r.segment<3>(3 * i) - step * q.segment<3>(3 * i);
      r.segment<3>(3 * i) = rest;
      return total + rest.squaredNorm();
    });
  }
  /// z = (block diagonal)^-1 r; returns r.z
  double precondition() {
    return sum([&](Index i, double total) {
      const Vec3 rest = r.segment<3>(3 * i);
      const Vec3 solved = inverse_diagonal_[static_cast<std::size_t>(i)] * rest;
      z.segment<3>(3 * i) = solved;
      return total + rest.dot(solved);
    });
  }
  /// p = z + factor p
  void turn(double factor) {
    sum([&](Index i, double) {
      p.segment<3>(3 * i) = z.segment<3>(3 * i) + factor * p.segment<3>(3 * i);
      return 0.0;
    });
  }

  VecX r, p, q, z;

 private:
  /// Runs accumulate(i, total) over all block rows range by range and adds the ranges in order.
  template <class Accumulate>
  double sum(const Accumulate& accumulate) {
    std::array<double, kMaxTasks> part;
    for_row_ranges(n_, [&](Index task, Index begin, Index end) {
      double total = 0.0;
      for (Index i = begin; i < end; ++i) total = accumulate(i, total);
      part[static_cast<std::size_t>(task)] = total;
    });
    double total = 0.0;
    for (Index task = 0; task < task_count(n_); ++task)
      total += part[static_cast<std::size_t>(task)];
    return total;
  }

  /// Inverse diagonal blocks; a block that is not positive definite is replaced by its absolute
  /// diagonal.
  void invert_diagonal() {
    inverse_diagonal_.resize(static_cast<std::size_t>(n_));
    for_rows(n_, [&](Index i) {
      const Mat3& block = A_.blocks()[static_cast<std::size_t>(A_.slot(i, i))];
      const double minor = block(0, 0) * block(1, 1) - block(0, 1) * block(1, 0);
      const double determinant = block.determinant();
      const double scale = block.cwiseAbs().maxCoeff();
      Mat3& inverse = inverse_diagonal_[static_cast<std::size_t>(i)];
      if (block(0, 0) > 0.0 && minor > 0.0 && determinant > 1e-14 * scale * scale * scale) {
        inverse = block.inverse();
        inverse = (0.5 * (inverse + inverse.transpose())).eval();
      } else {
        const double one = scale > 0.0 ? scale : 1.0;
        inverse.setZero();
        for (int k = 0; k < 3; ++k)
          inverse(k, k) = 1.0 / std::max(std::abs(block(k, k)), 1e-3 * one);
      }
    });
  }

  const BlockMatrix& A_;
  VecX& x_;
  Index n_;
  std::vector<Mat3> inverse_diagonal_;
};

void check(const BlockMatrix& A, const VecX& b, const VecX& x, const CgOptions& options) {
  const Eigen::Index size = 3 * Eigen::Index{A.n()};
  require(b.size() == size && x.size() == size, "conjugate_gradient: the matrix has ", size,
          " rows, b has ", b.size(), " and x has ", x.size(), " values");
  require(options.tolerance > 0.0 && options.tolerance < 1.0,
          "CgOptions::tolerance must be in (0, 1), got ", options.tolerance);
  require(options.max_iterations > 0, "CgOptions::max_iterations must be positive, got ",
          options.max_iterations);
}

}  // namespace

SolveReport conjugate_gradient(const BlockMatrix& A, const VecX& b, VecX& x,
                               const CgOptions& options, const std::function<void(VecX&)>& filter) {
  check(A, b, x, options);
  const auto apply_filter = [&](VecX& values) {
    if (filter) filter(values);
  };
  Workspace work(A, x);
  work.r = b;
  apply_filter(work.r);
  const double norm_b = std::sqrt(work.dot(work.r, work.r));
  work.start(b);
  apply_filter(work.r);

  // the scale of the residual is b's, or the start's where b has no part that may move
  double residual = std::sqrt(work.dot(work.r, work.r));
  const double scale = norm_b > 0.0 ? norm_b : residual;
  SolveReport report;
  const auto done = [&] {
    report.residual = scale > 0.0 ? residual / scale : 0.0;
    report.converged = report.residual <= options.tolerance;
    return report.converged;
  };
  if (done()) return report;

  double rho = work.precondition();
  work.p = work.z;
  apply_filter(work.p);
  for (report.iterations = 1;; ++report.iterations) {
    const double curvature = work.multiply();
    apply_filter(work.q);
    if (!(curvature > 0.0)) {
      report.reason = std::isnan(curvature) ? "the matrix or the right side holds NaN"
                                            : "direction of non-positive curvature";
      return report;
    }
    residual = std::sqrt(work.advance(rho / curvature));
    if (done()) return report;
    if (report.iterations == options.max_iterations) {
      report.reason = join_text("residual ", report.residual, " after ", options.max_iterations,
                                " iterations, tolerance ", options.tolerance);
      return report;
    }
    const double rho_before = rho;
    rho = work.precondition();
    if (filter) {
      apply_filter(work.z);
    }
    work.turn(rho / rho_before);
  }
}

}  // namespace coxa::solve
