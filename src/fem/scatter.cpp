#include "scatter.h"

#include <coxa/core/parallel.h>

#include <algorithm>

namespace coxa::fem {
namespace {

using Size = std::size_t;

constexpr std::int64_t kMaxTasks = 64;  // at most; each keeps its own row of blocks

}  // namespace

Scatter::Scatter(std::vector<std::int64_t> group_start, std::vector<Index> particle)
    : group_start_(std::move(group_start)), particle_(std::move(particle)) {
  for (Index g = 0; g < n_groups(); ++g) {
    const std::int64_t n = size(g);
    block_start_.push_back(block_start_.back() + n * (n + 1) / 2);
    square_start_.push_back(square_start_.back() + n * n);
    group_of_.insert(group_of_.end(), static_cast<Size>(n), g);
  }
  find_rows();
  find_neighbours();
}

void Scatter::find_rows() {
  const Index n_particles =
      particle_.empty() ? 0 : *std::max_element(particle_.begin(), particle_.end()) + 1;
  std::vector<std::int64_t> count(static_cast<Size>(n_particles), 0);
  for (const Index p : particle_) ++count[static_cast<Size>(p)];
  std::vector<Size> row_of(static_cast<Size>(n_particles));
  use_start_ = {0};
  for (Index p = 0; p < n_particles; ++p) {
    if (count[static_cast<Size>(p)] == 0) continue;
    row_of[static_cast<Size>(p)] = rows_.size();
    rows_.push_back(p);
    use_start_.push_back(use_start_.back() + count[static_cast<Size>(p)]);
  }
  uses_.resize(particle_.size());
  std::vector<std::int64_t> next(use_start_.begin(), use_start_.end() - 1);
  for (Size k = 0; k < particle_.size(); ++k)
    uses_[static_cast<Size>(next[row_of[static_cast<Size>(particle_[k])]]++)] =
        static_cast<std::int64_t>(k);
}

void Scatter::find_neighbours() {
  entry_.resize(static_cast<Size>(square_start_.back()));
  neighbour_start_ = {0};
  std::vector<Index> found;
  for (Size row = 0; row < rows_.size(); ++row) {
    const auto begin = uses_.begin() + use_start_[row], end = uses_.begin() + use_start_[row + 1];
    found.clear();
    for (auto use = begin; use != end; ++use) {
      const Index group = group_of_[static_cast<Size>(*use)];
      found.insert(found.end(), particle_.begin() + group_start_[static_cast<Size>(group)],
                   particle_.begin() + group_start_[static_cast<Size>(group) + 1]);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    for (auto use = begin; use != end; ++use) {
      const Size group = static_cast<Size>(group_of_[static_cast<Size>(*use)]);
      const Size n = static_cast<Size>(size(static_cast<Index>(group)));
      const Size first = slot(static_cast<Index>(group));
      const Size entries =
          static_cast<Size>(square_start_[group]) + (static_cast<Size>(*use) - first) * n;
      for (Size b = 0; b < n; ++b)
        entry_[entries + b] = static_cast<Index>(
            std::lower_bound(found.begin(), found.end(), particle_[first + b]) - found.begin());
    }
    neighbours_.insert(neighbours_.end(), found.begin(), found.end());
    neighbour_start_.push_back(static_cast<std::int64_t>(neighbours_.size()));
  }
}

std::vector<std::pair<Index, Index>> Scatter::pattern() const {
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(neighbours_.size());
  for (Size row = 0; row < rows_.size(); ++row)
    for (auto k = neighbour_start_[row]; k < neighbour_start_[row + 1]; ++k)
      pairs.emplace_back(rows_[row], neighbours_[static_cast<Size>(k)]);
  return pairs;
}

void Scatter::gather_force(const Vec3* part, VecX& force) const {
  parallel_for(static_cast<std::int64_t>(rows_.size()), [&](Index r) {
    const Size row = static_cast<Size>(r);
    Vec3 sum = Vec3::Zero();
    for (auto k = use_start_[row]; k < use_start_[row + 1]; ++k)
      sum += part[uses_[static_cast<Size>(k)]];
    force.segment<3>(3 * Eigen::Index{rows_[row]}) += sum;
  });
}

void Scatter::gather_blocks(const Mat3* part, solve::BlockMatrix& A) const {
  const auto n_rows = static_cast<std::int64_t>(rows_.size());
  const auto tasks = std::min(kMaxTasks, n_rows);
  parallel_for(tasks, [&](Index task) {
    std::vector<Mat3> sums;
    for (auto row = static_cast<Size>(n_rows * task / tasks);
         row < static_cast<Size>(n_rows * (task + 1) / tasks); ++row) {
      const auto first = neighbour_start_[row], last = neighbour_start_[row + 1];
      sums.assign(static_cast<Size>(last - first), Mat3::Zero());
      for (auto k = use_start_[row]; k < use_start_[row + 1]; ++k) {
        const Size use = static_cast<Size>(uses_[static_cast<Size>(k)]);
        const Index group = group_of_[use];
        const int n = size(group), a = static_cast<int>(use - slot(group));
        const Mat3* blocks = part + block(group);
        const Index* entry = &entry_[static_cast<Size>(square_start_[static_cast<Size>(group)] +
                                                       std::int64_t{a} * n)];
        for (int b = 0; b < a; ++b)
          sums[static_cast<Size>(entry[b])] += blocks[block_number(n, b, a)].transpose();
        for (int b = a; b < n; ++b)
          sums[static_cast<Size>(entry[b])] += blocks[block_number(n, a, b)];
      }
      // both lists of columns ascend
      auto at = A.row_start()[static_cast<Size>(rows_[row])];
      for (auto k = first; k < last; ++k) {
        while (A.columns()[static_cast<Size>(at)] != neighbours_[static_cast<Size>(k)]) ++at;
        A.blocks()[static_cast<Size>(at)] += sums[static_cast<Size>(k - first)];
      }
    }
  });
}

}  // namespace coxa::fem
