#pragma once

#include <coxa/core/types.h>
#include <coxa/solve/block_matrix.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace coxa::fem {

/// Sums what groups of nodes (elements, patches) contribute to particles, particle by particle in
/// the order of the groups: results do not depend on the number of threads.
///
/// A slot is a node of a group; a group of n slots has n (n + 1) / 2 blocks, those of pairs (a, b)
/// with a <= b.
class Scatter {
 public:
  Scatter() = default;
  /// @param group_start  where each group's slots begin, then their number   @param particle  of
  /// each slot
  Scatter(std::vector<std::int64_t> group_start, std::vector<Index> particle);

  Index n_groups() const { return static_cast<Index>(group_start_.size()) - 1; }
  int size(Index group) const { return static_cast<int>(slot(group + 1) - slot(group)); }
  /// First slot of a group.
  std::size_t slot(Index group) const {
    return static_cast<std::size_t>(group_start_[static_cast<std::size_t>(group)]);
  }
  Index particle(std::size_t slot) const { return particle_[slot]; }
  std::size_t n_slots() const { return particle_.size(); }
  /// First block of a group.
  std::size_t block(Index group) const {
    return static_cast<std::size_t>(block_start_[static_cast<std::size_t>(group)]);
  }
  std::size_t n_blocks() const { return static_cast<std::size_t>(block_start_.back()); }
  /// Place of block (a, b), a <= b, among the blocks of a group of n.
  static int block_number(int n, int a, int b) { return a * n - a * (a - 1) / 2 + b - a; }

  std::vector<std::pair<Index, Index>> pattern() const;
  /// Adds one value a slot to the particles.
  void gather_force(const Vec3* part, VecX& force) const;
  /// Adds the blocks of all groups, and their transposes, to the matrix.
  void gather_blocks(const Mat3* part, solve::BlockMatrix& A) const;

 private:
  void find_rows();
  void find_neighbours();

  std::vector<std::int64_t> group_start_{0}, block_start_{0}, square_start_{0};
  std::vector<Index> particle_;  // of each slot
  std::vector<Index> group_of_;  // of each slot

  std::vector<Index> rows_;              // the particles that occur, ascending
  std::vector<std::int64_t> use_start_;  // per row, where its uses begin
  std::vector<std::int64_t> uses_;       // the slots of each row, ascending
  std::vector<std::int64_t> neighbour_start_;
  std::vector<Index> neighbours_;  // per row, the particles it shares a group with, ascending
  std::vector<Index> entry_;       // per slot and slot of its group: place in the row's neighbours
};

}  // namespace coxa::fem
