#include "lattice.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace coxa::meshing {
namespace {

using PointKey = std::int64_t;

PointKey key_of(const GridPoint& p) {
  return (static_cast<PointKey>(p[2]) << 42) + (static_cast<PointKey>(p[1]) << 21) + p[0];
}

GridPoint moved(GridPoint p, std::size_t axis, int step) {
  p[axis] += step;
  return p;
}

class Builder {
 public:
  explicit Builder(const Octree& octree) : octree_(octree) {
    std::vector<GridPoint> all;
    for (const OctreeCell& cell : octree.cells()) {
      if (cell.children > 0) continue;
      for (int corner = 0; corner < 8; ++corner)
        all.push_back({cell.low[0] + cell.size * (corner & 1),
                       cell.low[1] + cell.size * (corner >> 1 & 1),
                       cell.low[2] + cell.size * (corner >> 2)});
      centres_.push_back(key_of(cell.centre()));
      all.push_back(cell.centre());
    }
    std::sort(all.begin(), all.end(),
              [](const GridPoint& a, const GridPoint& b) { return key_of(a) < key_of(b); });
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::sort(centres_.begin(), centres_.end());
    for (const GridPoint& p : all) {
      keys_.push_back(key_of(p));
      made_.points.push_back(octree.position(p));
      made_.is_centre.push_back(std::binary_search(centres_.begin(), centres_.end(), keys_.back()));
    }
  }

  Lattice build() {
    for (const OctreeCell& cell : octree_.cells()) {
      if (cell.children > 0) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) fill_face(cell, axis, side);
    }
    return std::move(made_);
  }

 private:
  bool exists(const GridPoint& p) const {
    return std::binary_search(keys_.begin(), keys_.end(), key_of(p));
  }
  Index number(const GridPoint& p) const {
    return static_cast<Index>(std::lower_bound(keys_.begin(), keys_.end(), key_of(p)) -
                              keys_.begin());
  }

  void add(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
    Tet t{number(a), number(b), number(c), number(d)};
    const auto x = [&](std::size_t k) { return made_.points[static_cast<std::size_t>(t[k])]; };
    if (volume6(x(0), x(1), x(2), x(3)) < 0.0) std::swap(t[2], t[3]);
    made_.tets.push_back(t);
  }

  void fill_face(const OctreeCell& cell, std::size_t axis, int side) {
    const GridPoint middle = cell.centre();
    const OctreeCell* next = octree_.leaf_at(moved(middle, axis, side * cell.size));
    if (next == nullptr || next->size < cell.size || (next->size == cell.size && side < 0)) return;
    const GridPoint face = moved(middle, axis, side * cell.size / 2);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int half = cell.size / 2;
    std::array<GridPoint, 4> corners;
    constexpr int kSigns[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t k = 0; k < 4; ++k)
      corners[k] = moved(moved(face, u, half * kSigns[k][0]), v, half * kSigns[k][1]);
    if (next->size == cell.size) {
      for (std::size_t k = 0; k < 4; ++k)
        fill_edge(middle, next->centre(), corners[k], corners[(k + 1) % 4]);
      return;
    }
    // the diagonal of the small face runs through the middle of the large one
    const GridPoint large = next->centre();
    const bool first = (corners[0][u] == large[u] && corners[0][v] == large[v]) ||
                       (corners[2][u] == large[u] && corners[2][v] == large[v]);
    const std::size_t k = first ? 0 : 1;
    for (const GridPoint& apex : {middle, large}) {
      add(apex, corners[k], corners[k + 1], corners[k + 2]);
      add(apex, corners[k], corners[k + 2], corners[(k + 3) % 4]);
    }
  }

  // between two cubes of one size: whole, or halved where smaller cubes split the edge
  void fill_edge(const GridPoint& a, const GridPoint& b, const GridPoint& p, const GridPoint& q) {
    const GridPoint half{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
    if (!exists(half)) {
      add(a, b, p, q);
    } else {
      add(a, b, p, half);
      add(a, b, half, q);
    }
  }

  const Octree& octree_;
  std::vector<PointKey> keys_, centres_;
  Lattice made_;
};

}  // namespace

Lattice make_lattice(const Octree& octree) { return Builder(octree).build(); }

}  // namespace coxa::meshing
