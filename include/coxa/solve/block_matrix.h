#pragma once

#include <coxa/core/types.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace coxa::solve {

/// Square sparse matrix of 3×3 blocks in compressed rows; the pattern is fixed, the values change.
///
/// Rows and columns are particles. Symmetric patterns store both halves.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// @param n rows   @param pairs (row, column) blocks that may be non-zero; duplicates allowed,
  /// the
  ///        diagonal is always included
  BlockMatrix(Index n, const std::vector<std::pair<Index, Index>>& pairs);

  Index n() const { return static_cast<Index>(row_start_.size()) - 1; }
  void set_zero();
  /// Position of block (row, column) in `blocks()`; it must be in the pattern.
  std::int64_t slot(Index row, Index column) const;
  std::vector<Mat3>& blocks() { return blocks_; }
  const std::vector<Mat3>& blocks() const { return blocks_; }
  Mat3& at(Index row, Index column) { return blocks_[static_cast<std::size_t>(slot(row, column))]; }
  const std::vector<std::int64_t>& row_start() const { return row_start_; }
  const std::vector<Index>& columns() const { return columns_; }

  /// y = A x over 3n values; parallel over rows, bit-identical for any number of threads.
  void multiply(const VecX& x, VecX& y) const;
  /// Block row `row` of A times x, 3 values; `x` has 3n.
  Vec3 row_times(Index row, const double* x) const {
    const auto begin = row_start_[static_cast<std::size_t>(row)];
    const auto end = row_start_[static_cast<std::size_t>(row) + 1];
    double y0 = 0.0, y1 = 0.0, y2 = 0.0;
    for (auto slot = begin; slot < end; ++slot) {
      const double* a = blocks_[static_cast<std::size_t>(slot)].data();  // column by column
      const double* u = x + 3 * std::int64_t{columns_[static_cast<std::size_t>(slot)]};
      y0 += a[0] * u[0] + a[3] * u[1] + a[6] * u[2];
      y1 += a[1] * u[0] + a[4] * u[1] + a[7] * u[2];
      y2 += a[2] * u[0] + a[5] * u[1] + a[8] * u[2];
    }
    return {y0, y1, y2};
  }

 private:
  std::vector<std::int64_t> row_start_{0};
  std::vector<Index> columns_;
  std::vector<Mat3> blocks_;
};

}  // namespace coxa::solve
