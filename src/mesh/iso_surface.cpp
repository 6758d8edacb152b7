#include <coxa/mesh/iso_surface.h>

#include <coxa/core/error.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace coxa {
namespace {

constexpr Index kNone = -1;
constexpr double kClearance = 0.01;  // share of a grid edge

// corners of a cell are numbered by bits x, y, z; each tetrahedron climbs from 0 to 7 axis by axis,
// and its first two entries are swapped where needed to make its volume positive
constexpr std::array<std::array<int, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {5, 1, 0, 7}, {3, 2, 0, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {6, 4, 0, 7}}};

class Marcher {
 public:
  Marcher(const std::array<Index, 3>& size, std::span<const float> values, double level,
          const std::function<Vec3(const Vec3&)>& position)
      : size_(size), values_(values), level_(level), position_(position) {
    const Vec3 origin = position(Vec3::Zero());
    Mat3 axes;
    for (int k = 0; k < 3; ++k) axes.col(k) = position(Vec3::Unit(k)) - origin;
    mirrored_ = axes.determinant() < 0.0;
    outside_ = *std::min_element(values.begin(), values.end());
    row_ = size[0] + 2;
    for (auto& slab : vertex_on_edge_)
      slab.assign(static_cast<std::size_t>(row_) * (static_cast<std::size_t>(size[1]) + 2) * 8,
                  kNone);
  }

  TriMesh run() {
    for (Index k = -1; k < size_[2]; ++k) {
      for (Index j = -1; j < size_[1]; ++j)
        for (Index i = -1; i < size_[0]; ++i) march_cell({i, j, k});
      std::swap(vertex_on_edge_[0], vertex_on_edge_[1]);
      std::fill(vertex_on_edge_[1].begin(), vertex_on_edge_[1].end(), kNone);
    }
    TriMesh mesh;
    mesh.points =
        Eigen::Map<const Points>(points_.data(), static_cast<Index>(points_.size() / 3), 3);
    mesh.triangles = Eigen::Map<const Triangles>(triangles_.data(),
                                                 static_cast<Index>(triangles_.size() / 3), 3);
    return mesh;
  }

 private:
  double value(const std::array<Index, 3>& at) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (at[k] < 0 || at[k] >= size_[k]) return outside_;
    return values_[static_cast<std::size_t>(at[0]) +
                   static_cast<std::size_t>(size_[0]) *
                       (static_cast<std::size_t>(at[1]) +
                        static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(at[2]))];
  }

  static std::array<Index, 3> corner(const std::array<Index, 3>& cell, int bits) {
    return {cell[0] + (bits & 1), cell[1] + ((bits >> 1) & 1), cell[2] + (bits >> 2)};
  }

  void march_cell(const std::array<Index, 3>& cell) {
    std::array<double, 8> v;
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      v[static_cast<std::size_t>(c)] = value(corner(cell, c));
      inside |= (v[static_cast<std::size_t>(c)] > level_) << c;
    }
    if (inside == 0 || inside == 255) return;
    for (const auto& tet : kTetrahedra) march_tetrahedron(cell, v, tet);
  }

  void march_tetrahedron(const std::array<Index, 3>& cell, const std::array<double, 8>& v,
                         const std::array<int, 4>& tet) {
    // the inside corners first, by swaps that keep the orientation
    std::array<int, 4> order = tet;
    const auto is_inside = [&](int c) { return v[static_cast<std::size_t>(c)] > level_; };
    const auto n_inside = std::count_if(order.begin(), order.end(), is_inside);
    if (n_inside == 0 || n_inside == 4) return;
    std::stable_partition(order.begin(), order.end(), is_inside);
    if (is_odd(order, tet)) {
      // two corners of one kind change places
      n_inside == 3 ? std::swap(order[0], order[1]) : std::swap(order[2], order[3]);
    }
    const auto [i, j, k, l] = order;
    const auto e = [&](int a, int b) { return edge_vertex(cell, v, a, b); };
    if (n_inside == 1) {
      add(e(i, j), e(i, k), e(i, l));
    } else if (n_inside == 3) {
      add(e(l, i), e(l, j), e(l, k));
    } else {
      const Index ik = e(i, k), il = e(i, l), jl = e(j, l), jk = e(j, k);
      add(ik, il, jl);
      add(ik, jl, jk);
    }
  }

  static bool is_odd(const std::array<int, 4>& order, const std::array<int, 4>& tet) {
    std::array<std::ptrdiff_t, 4> place{};
    for (std::size_t a = 0; a < 4; ++a)
      place[a] = std::find(tet.begin(), tet.end(), order[a]) - tet.begin();
    int inversions = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) inversions += place[a] > place[b];
    return inversions % 2 == 1;
  }

  // vertex on the grid edge between two corners of a cell, made when first asked for
  Index edge_vertex(const std::array<Index, 3>& cell, const std::array<double, 8>& v, int a,
                    int b) {
    const int low = a & b, high = a | b;  // one of them: the bits of one corner include the other's
    const auto from = corner(cell, low);
    auto& slab = vertex_on_edge_[static_cast<std::size_t>(low >> 2)];
    Index& vertex = slab[8 * static_cast<std::size_t>((from[1] + 1) * row_ + from[0] + 1) +
                         static_cast<std::size_t>(high ^ low)];
    if (vertex != kNone) return vertex;
    const double v0 = v[static_cast<std::size_t>(low)], v1 = v[static_cast<std::size_t>(high)];
    const double s = std::clamp((level_ - v0) / (v1 - v0), kClearance, 1.0 - kClearance);
    const auto to = corner(cell, high);
    const Vec3 p0(from[0], from[1], from[2]), p1(to[0], to[1], to[2]);
    const Vec3 p = position_(p0 + s * (p1 - p0));
    vertex = static_cast<Index>(points_.size() / 3);
    points_.insert(points_.end(), {p[0], p[1], p[2]});
    return vertex;
  }

  void add(Index a, Index b, Index c) {
    if (mirrored_) std::swap(b, c);
    triangles_.insert(triangles_.end(), {a, b, c});
  }

  std::array<Index, 3> size_;
  std::span<const float> values_;
  double level_;
  const std::function<Vec3(const Vec3&)>& position_;
  bool mirrored_ = false;
  double outside_ = 0.0;
  Index row_ = 0;
  std::array<std::vector<Index>, 2>
      vertex_on_edge_;  // edges that start in this layer and in the next
  std::vector<double> points_;
  std::vector<Index> triangles_;
};

}  // namespace

TriMesh iso_surface(const std::array<Index, 3>& size, std::span<const float> values, double level,
                    const std::function<Vec3(const Vec3& index)>& position) {
  require(size[0] > 0 && size[1] > 0 && size[2] > 0 &&
              static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                      static_cast<std::size_t>(size[2]) ==
                  values.size(),
          "iso_surface: ", values.size(), " values for a grid of ", size[0], " x ", size[1], " x ",
          size[2]);
  require(std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }),
          "iso_surface: a value is not finite");
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  require(*high > level && *low <= level, "iso_surface: the level ", level,
          " is not between the lowest and highest value, ", *low, " and ", *high);
  return Marcher(size, values, level, position).run();
}

}  // namespace coxa
