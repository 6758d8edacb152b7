#pragma once

#include <coxa/core/types.h>

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace coxa::medial {

/// Triangulated sheet under edition: local operations on a manifold with border.
///
/// Removed triangles and nodes stay as holes in the arrays until `compact`.
class SheetGrid {
 public:
  using Cell = std::array<Index, 3>;

  SheetGrid(std::vector<Vec3> nodes, const std::vector<Cell>& cells);

  std::vector<Vec3> x;       ///< positions, mm
  std::vector<double> size;  ///< wanted edge length, mm
  std::vector<char> rim;     ///< 1 on the border
  std::vector<char> pinned;  ///< 1 at corners of the border, which keep their place

  Index n_nodes() const { return static_cast<Index>(x.size()); }
  bool alive(Index node) const { return !around(node).empty(); }
  const std::vector<Index>& around(Index node) const { return around_[at(node)]; }
  const Cell& cell(Index c) const { return cells_[at(c)]; }
  Index n_cells() const { return n_alive_; }
  std::vector<Cell> cells() const;                     ///< living cells, in order
  std::vector<std::pair<Index, Index>> edges() const;  ///< a < b, sorted
  std::vector<Index> neighbours(Index node) const;     ///< sorted
  Vec3 normal(Index node) const;                       ///< unit, area-weighted; zero if degenerate
  bool has_edge(Index a, Index b) const;
  bool on_border(Index a, Index b) const;  ///< edge of one cell only

  /// New node at `place` on edge a-b.
  Index split(Index a, Index b, const Vec3& place);
  /// Moves b into a at `place` unless that would fold the sheet, break it, or make an edge longer
  /// than `limit` times the wanted length.
  /// @param up  unit normal the cells should have afterwards; without it they must not turn much
  bool collapse(Index a, Index b, const Vec3& place, double limit,
                const std::optional<Vec3>& up = std::nullopt);
  /// The corners across edge a-b (left, right of a -> b), if the edge is inside.
  std::optional<std::pair<Index, Index>> across(Index a, Index b) const;
  /// Removes the only cell of a node on the border.
  void drop_ear(Index node) { remove_cell(around(node).front()); }
  /// Replaces edge a-b by the edge joining the two corners across; false if it would fold, or join
  /// two nodes of the border.
  bool flip(Index a, Index b);
  /// Drops dead nodes; returns old number -> new (-1 for dead).
  std::vector<Index> compact();

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  std::vector<Index> cells_at_edge(Index a, Index b) const;
  bool collapse_folds(Index a, Index b, const Vec3& place, const std::optional<Vec3>& up);
  Vec3 area_vector(const Cell& c) const;
  void remove_cell(Index c);
  Index add_cell(const Cell& c);

  std::vector<Cell> cells_;
  std::vector<char> alive_;
  std::vector<std::vector<Index>> around_;
  Index n_alive_ = 0;
};

}  // namespace coxa::medial
