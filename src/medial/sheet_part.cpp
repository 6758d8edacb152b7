#include <coxa/medial/sheet_part.h>

#include <algorithm>
#include <map>
#include <utility>

namespace coxa::medial {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// of the living cells, those outside the largest piece go; true if there were any
bool drop_lesser_pieces(const std::vector<SheetCell>& cells, const std::vector<double>& areas,
                        std::vector<char>& alive) {
  std::vector<SheetCell> living;
  std::vector<std::size_t> number;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!alive[c]) continue;
    living.push_back(cells[c]);
    number.push_back(c);
  }
  if (living.empty()) return false;
  const std::vector<Index> piece = sheet_pieces(living);
  std::vector<double> total(1 + at(*std::max_element(piece.begin(), piece.end())), 0.0);
  for (std::size_t i = 0; i < living.size(); ++i) total[at(piece[i])] += areas[number[i]];
  const auto largest = std::max_element(total.begin(), total.end()) - total.begin();
  bool dropped = false;
  for (std::size_t i = 0; i < living.size(); ++i) {
    if (piece[i] == largest) continue;
    alive[number[i]] = 0;
    dropped = true;
  }
  return dropped;
}

// where living cells meet in a node only, all fans but the largest go; true if there were any
bool drop_pinches(const std::vector<SheetCell>& cells, std::vector<char>& alive) {
  std::map<Index, std::vector<std::size_t>> around;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!alive[c]) continue;
    for (const Index v : cells[c]) around[v].push_back(c);
  }
  bool dropped = false;
  for (const auto& [node, list] : around) {
    std::vector<SheetCell> fan;
    for (const std::size_t c : list) fan.push_back(cells[c]);
    const std::vector<Index> piece = sheet_pieces(fan);
    std::vector<int> count(1 + at(*std::max_element(piece.begin(), piece.end())), 0);
    for (const Index p : piece) ++count[at(p)];
    const auto largest = std::max_element(count.begin(), count.end()) - count.begin();
    for (std::size_t i = 0; i < fan.size(); ++i) {
      if (piece[i] == largest) continue;
      alive[list[i]] = 0;
      dropped = true;
    }
  }
  return dropped;
}

}  // namespace

std::vector<Index> sheet_pieces(const std::vector<SheetCell>& cells) {
  std::vector<std::pair<std::pair<Index, Index>, Index>> sides;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = cells[c][k], b = cells[c][(k + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<Index>(c)});
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<std::vector<Index>> beside(cells.size());
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].first != sides[i - 1].first) continue;
    beside[at(sides[i].second)].push_back(sides[i - 1].second);
    beside[at(sides[i - 1].second)].push_back(sides[i].second);
  }
  std::vector<Index> piece(cells.size(), -1);
  Index count = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (piece[c] >= 0) continue;
    std::vector<Index> stack{static_cast<Index>(c)};
    piece[c] = count;
    while (!stack.empty()) {
      const Index top = stack.back();
      stack.pop_back();
      for (const Index next : beside[at(top)]) {
        if (piece[at(next)] >= 0) continue;
        piece[at(next)] = count;
        stack.push_back(next);
      }
    }
    ++count;
  }
  return piece;
}

std::vector<char> manifold_part(const std::vector<SheetCell>& cells,
                                const std::vector<double>& areas) {
  std::vector<char> alive(cells.size(), 1);
  drop_lesser_pieces(cells, areas, alive);
  while (drop_pinches(cells, alive)) drop_lesser_pieces(cells, areas, alive);
  return alive;
}

}  // namespace coxa::medial
