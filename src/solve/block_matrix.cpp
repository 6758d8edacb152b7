#include <coxa/solve/block_matrix.h>

#include <coxa/core/error.h>

#include <algorithm>

#include "rows.h"

namespace coxa::solve {
namespace {

using Size = std::size_t;

/// Start of each row when the pairs, and one diagonal entry a row, are grouped by row.
std::vector<std::int64_t> count_rows(Index n, const std::vector<std::pair<Index, Index>>& pairs) {
  std::vector<std::int64_t> start(static_cast<Size>(n) + 1, 0);
  for (Index i = 0; i < n; ++i) start[static_cast<Size>(i) + 1] = 1;
  for (const auto& [row, column] : pairs) {
    require(row >= 0 && row < n && column >= 0 && column < n, "block (", row, ", ", column,
            ") lies outside a matrix of ", n, " rows");
    ++start[static_cast<Size>(row) + 1];
  }
  for (Size i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  return start;
}

}  // namespace

BlockMatrix::BlockMatrix(Index n, const std::vector<std::pair<Index, Index>>& pairs) {
  require(n >= 0, "a matrix cannot have ", n, " rows");
  const std::vector<std::int64_t> start = count_rows(n, pairs);

  // group the columns by row: the diagonal first, then the pairs in their order
  std::vector<Index> grouped(static_cast<Size>(start.back()));
  std::vector<std::int64_t> next(start.begin(), start.end() - 1);
  for (Index i = 0; i < n; ++i) grouped[static_cast<Size>(next[static_cast<Size>(i)]++)] = i;
  for (const auto& [row, column] : pairs)
    grouped[static_cast<Size>(next[static_cast<Size>(row)]++)] = column;

  // sort each row and drop its duplicates
  std::vector<std::int64_t> length(static_cast<Size>(n));
  for_rows(n, [&](Index i) {
    const auto begin = grouped.begin() + start[static_cast<Size>(i)];
    const auto end = grouped.begin() + start[static_cast<Size>(i) + 1];
    std::sort(begin, end);
    length[static_cast<Size>(i)] = std::unique(begin, end) - begin;
  });
  row_start_.assign(static_cast<Size>(n) + 1, 0);
  for (Size i = 0; i < length.size(); ++i) row_start_[i + 1] = row_start_[i] + length[i];
  columns_.resize(static_cast<Size>(row_start_.back()));
  for_rows(n, [&](Index i) {
    const Size row = static_cast<Size>(i);
    std::copy_n(grouped.begin() + start[row], length[row], columns_.begin() + row_start_[row]);
  });
  blocks_.assign(columns_.size(), Mat3::Zero());
}

void BlockMatrix::set_zero() {
  for_rows(n(), [&](Index i) {
    const Size row = static_cast<Size>(i);
    std::fill(blocks_.begin() + row_start_[row], blocks_.begin() + row_start_[row + 1],
              Mat3::Zero());
  });
}

std::int64_t BlockMatrix::slot(Index row, Index column) const {
  const auto begin = columns_.begin() + row_start_[static_cast<Size>(row)];
  const auto end = columns_.begin() + row_start_[static_cast<Size>(row) + 1];
  const auto found = std::lower_bound(begin, end, column);
  COXA_ASSERT(found != end && *found == column);
  return found - columns_.begin();
}

void BlockMatrix::multiply(const VecX& x, VecX& y) const {
  require(x.size() == 3 * Eigen::Index{n()}, "a matrix of ", n(), " block rows cannot multiply ",
          x.size(), " values");
  y.resize(x.size());
  for_rows(n(), [&](Index i) { y.segment<3>(3 * Eigen::Index{i}) = row_times(i, x.data()); });
}

}  // namespace coxa::solve
