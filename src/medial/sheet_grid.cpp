#include "sheet_grid.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace coxa::medial {
namespace {

bool contains(const SheetGrid::Cell& c, Index v) { return c[0] == v || c[1] == v || c[2] == v; }

// the corner that follows v counter-clockwise
Index next(const SheetGrid::Cell& c, Index v) { return c[0] == v ? c[1] : c[1] == v ? c[2] : c[0]; }

Index third(const SheetGrid::Cell& c, Index a, Index b) {
  for (const Index v : c) {
    if (v != a && v != b) return v;
  }
  return c[0];
}

// smallest cosine between the normals before and after an edition: below it the sheet would fold
constexpr double kFold = 0.3;

}  // namespace

SheetGrid::SheetGrid(std::vector<Vec3> nodes, const std::vector<Cell>& cells)
    : x(std::move(nodes)),
      size(x.size(), 1.0),
      rim(x.size(), 0),
      pinned(x.size(), 0),
      around_(x.size()) {
  for (const Cell& c : cells) add_cell(c);
  for (const auto& [a, b] : edges()) {
    if (on_border(a, b)) rim[at(a)] = rim[at(b)] = 1;
  }
}

std::vector<SheetGrid::Cell> SheetGrid::cells() const {
  std::vector<Cell> living;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (alive_[c]) living.push_back(cells_[c]);
  }
  return living;
}

std::vector<std::pair<Index, Index>> SheetGrid::edges() const {
  std::vector<std::pair<Index, Index>> all;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (!alive_[c]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = cells_[c][k], b = cells_[c][(k + 1) % 3];
      all.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<Index> SheetGrid::neighbours(Index node) const {
  std::vector<Index> result;
  for (const Index c : around(node)) {
    for (const Index v : cell(c)) {
      if (v != node) result.push_back(v);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Vec3 SheetGrid::area_vector(const Cell& c) const {
  return (x[at(c[1])] - x[at(c[0])]).cross(x[at(c[2])] - x[at(c[0])]);
}

Vec3 SheetGrid::normal(Index node) const {
  Vec3 sum = Vec3::Zero();
  for (const Index c : around(node)) sum += area_vector(cell(c));
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : Vec3(Vec3::Zero());
}

std::vector<Index> SheetGrid::cells_at_edge(Index a, Index b) const {
  std::vector<Index> result;
  for (const Index c : around(a)) {
    if (contains(cell(c), b)) result.push_back(c);
  }
  return result;
}

bool SheetGrid::has_edge(Index a, Index b) const { return !cells_at_edge(a, b).empty(); }
bool SheetGrid::on_border(Index a, Index b) const { return cells_at_edge(a, b).size() == 1; }

void SheetGrid::remove_cell(Index c) {
  for (const Index v : cells_[at(c)]) {
    auto& list = around_[at(v)];
    list.erase(std::find(list.begin(), list.end(), c));
  }
  alive_[at(c)] = 0;
  --n_alive_;
}

Index SheetGrid::add_cell(const Cell& c) {
  const Index number = static_cast<Index>(cells_.size());
  cells_.push_back(c);
  alive_.push_back(1);
  for (const Index v : c) around_[at(v)].push_back(number);
  ++n_alive_;
  return number;
}

Index SheetGrid::split(Index a, Index b, const Vec3& place) {
  const std::vector<Index> pair = cells_at_edge(a, b);
  const Index m = n_nodes();
  x.push_back(place);
  size.push_back(0.5 * (size[at(a)] + size[at(b)]));
  rim.push_back(pair.size() == 1 ? 1 : 0);
  pinned.push_back(0);
  around_.emplace_back();
  for (const Index c : pair) {
    Cell one = cell(c), two = one;
    for (std::size_t k = 0; k < 3; ++k) {
      if (one[k] == a) one[k] = m;
      if (two[k] == b) two[k] = m;
    }
    remove_cell(c);
    add_cell(one);
    add_cell(two);
  }
  return m;
}

bool SheetGrid::collapse_folds(Index a, Index b, const Vec3& place, const std::optional<Vec3>& up) {
  for (const Index end : {a, b}) {
    for (const Index c : around(end)) {
      if (contains(cell(c), a) && contains(cell(c), b)) continue;
      const Vec3 before = area_vector(cell(c));
      const Vec3 old = x[at(end)];
      x[at(end)] = place;
      const Vec3 after = area_vector(cell(c));
      x[at(end)] = old;
      if (up) {
        if (after.dot(*up) < kFold * after.norm()) return true;
      } else if (after.dot(before) < kFold * after.norm() * before.norm() ||
                 after.norm() < 0.05 * before.norm()) {
        return true;
      }
    }
  }
  return false;
}

bool SheetGrid::collapse(Index a, Index b, const Vec3& place, double limit,
                         const std::optional<Vec3>& up) {
  const std::vector<Index> pair = cells_at_edge(a, b);
  const std::vector<Index> na = neighbours(a), nb = neighbours(b);
  std::vector<Index> common;
  std::set_intersection(na.begin(), na.end(), nb.begin(), nb.end(), std::back_inserter(common));
  if (common.size() != pair.size()) return false;
  if (rim[at(a)] && rim[at(b)] && pair.size() != 1) return false;
  for (const Index v : common) {
    // a corner must keep a cell, an inner node at least three neighbours
    if (neighbours(v).size() <= (rim[at(v)] ? 2U : 3U)) return false;
  }
  if (n_alive_ <= static_cast<Index>(pair.size()) + 2) return false;
  for (const Index v : nb) {
    if (v != a && (x[at(v)] - place).norm() > limit * 0.5 * (size[at(v)] + size[at(a)]))
      return false;
  }
  if (collapse_folds(a, b, place, up)) return false;
  for (const Index c : pair) remove_cell(c);
  const std::vector<Index> moving = around(b);
  for (const Index c : moving) {
    Cell changed = cell(c);
    std::replace(changed.begin(), changed.end(), b, a);
    remove_cell(c);
    add_cell(changed);
  }
  x[at(a)] = place;
  rim[at(a)] = rim[at(a)] || rim[at(b)];
  pinned[at(a)] = pinned[at(a)] || pinned[at(b)];
  return true;
}

std::optional<std::pair<Index, Index>> SheetGrid::across(Index a, Index b) const {
  const std::vector<Index> pair = cells_at_edge(a, b);
  if (pair.size() != 2) return std::nullopt;
  const bool first_is_left = next(cell(pair[0]), a) == b;
  const Index c = third(cell(pair[0]), a, b), d = third(cell(pair[1]), a, b);
  return first_is_left ? std::pair{c, d} : std::pair{d, c};
}

bool SheetGrid::flip(Index a, Index b) {
  const auto corners = across(a, b);
  if (!corners) return false;
  const auto [c, d] = *corners;
  if (c == d || has_edge(c, d) || (rim[at(c)] && rim[at(d)])) return false;
  const std::vector<Index> pair = cells_at_edge(a, b);
  const Vec3 mean = area_vector(cell(pair[0])) + area_vector(cell(pair[1]));
  const Cell one{a, d, c}, two{d, b, c};
  for (const Cell& made : {one, two}) {
    const Vec3 n = area_vector(made);
    if (n.dot(mean) < kFold * n.norm() * mean.norm() || n.norm() < 1e-3 * mean.norm()) return false;
  }
  for (const Index c_old : pair) remove_cell(c_old);
  add_cell(one);
  add_cell(two);
  return true;
}

std::vector<Index> SheetGrid::compact() {
  std::vector<Index> number(x.size(), -1);
  Index count = 0;
  for (Index v = 0; v < n_nodes(); ++v) {
    if (!alive(v)) continue;
    number[at(v)] = count;
    x[at(count)] = x[at(v)];
    size[at(count)] = size[at(v)];
    rim[at(count)] = rim[at(v)];
    pinned[at(count)] = pinned[at(v)];
    ++count;
  }
  std::vector<Cell> living = cells();
  x.resize(at(count));
  size.resize(at(count));
  rim.resize(at(count));
  pinned.resize(at(count));
  around_.assign(at(count), {});
  cells_.clear();
  alive_.clear();
  n_alive_ = 0;
  for (Cell& c : living) {
    for (Index& v : c) v = number[at(v)];
    add_cell(c);
  }
  return number;
}

}  // namespace coxa::medial
