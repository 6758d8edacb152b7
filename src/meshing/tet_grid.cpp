#include "tet_grid.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace coxa::meshing {

double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

Index TetGrid::add(const Tet& tet) {
  const Index number = static_cast<Index>(tets.size());
  tets.push_back(tet);
  for (const Index v : tet) around[static_cast<std::size_t>(v)].push_back(number);
  return number;
}

void TetGrid::remove(Index t) {
  Tet& tet = tets[static_cast<std::size_t>(t)];
  for (const Index v : tet) {
    auto& list = around[static_cast<std::size_t>(v)];
    list.erase(std::find(list.begin(), list.end(), t));
  }
  tet[0] = -1;
}

std::ptrdiff_t TetGrid::n_living() const {
  return std::count_if(tets.begin(), tets.end(), [](const Tet& t) { return t[0] >= 0; });
}

void TetGrid::link() {
  tets.erase(std::remove_if(tets.begin(), tets.end(), [](const Tet& t) { return t[0] < 0; }),
             tets.end());
  reach.resize(x.size(), 0.0);
  around.assign(x.size(), {});
  std::vector<std::size_t> count(x.size(), 0);
  for (const Tet& t : tets)
    for (const Index v : t) ++count[static_cast<std::size_t>(v)];
  for (std::size_t v = 0; v < around.size(); ++v) around[v].reserve(count[v]);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (const Index v : tets[t])
      around[static_cast<std::size_t>(v)].push_back(static_cast<Index>(t));
  }
}

}  // namespace coxa::meshing
