#include <coxa/mesh/voxelize.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>

namespace coxa {
namespace {

struct Crossing {
  double x;
  int step;  // winding number gained when passing towards +x
  bool operator<(const Crossing& other) const {
    return x < other.x || (x == other.x && step > other.step);
  }
};

using Rows = std::vector<std::vector<Crossing>>;

// twice the signed area of abp in the y-z plane, the same magnitude bit for bit from both sides of
// edge ab
double side(const Vec3& a, const Vec3& b, double y, double z) {
  const bool ordered = a[1] < b[1] || (a[1] == b[1] && a[2] < b[2]);
  const Vec3& from = ordered ? a : b;
  const Vec3& to = ordered ? b : a;
  const double value = (to[1] - from[1]) * (z - from[2]) - (to[2] - from[2]) * (y - from[1]);
  return ordered ? value : -value;
}

// a row exactly above an edge belongs to the triangle for which the edge is "top-left"
bool covers(double value, const Vec3& a, const Vec3& b, double sign) {
  if (value * sign != 0.0) return value * sign > 0.0;
  const double dy = sign * (b[1] - a[1]), dz = sign * (b[2] - a[2]);
  return dz > 0.0 || (dz == 0.0 && dy < 0.0);
}

void add_crossings(const std::array<Vec3, 3>& p, const std::array<Index, 3>& size, Rows& rows) {
  const auto range = [&](int axis) {
    const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
    const double last = size[static_cast<std::size_t>(axis)] - 1;
    return std::pair{static_cast<Index>(std::ceil(std::clamp(low, 0.0, last + 1.0))),
                     static_cast<Index>(std::floor(std::clamp(high, -1.0, last)))};
  };
  const auto [y0, y1] = range(1);
  const auto [z0, z1] = range(2);
  for (Index z = z0; z <= z1; ++z)
    for (Index y = y0; y <= y1; ++y) {
      const Vec3 w(side(p[1], p[2], y, z), side(p[2], p[0], y, z), side(p[0], p[1], y, z));
      const double area = w.sum(), sign = area > 0.0 ? 1.0 : -1.0;
      if (area == 0.0 || !covers(w[0], p[1], p[2], sign) || !covers(w[1], p[2], p[0], sign) ||
          !covers(w[2], p[0], p[1], sign))
        continue;
      const double x = (w[0] * p[0][0] + w[1] * p[1][0] + w[2] * p[2][0]) / area;
      // normal towards +x: leaving the body
      rows[static_cast<std::size_t>(y) +
           static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(z)]
          .push_back({x, area > 0.0 ? -1 : 1});
    }
}

}  // namespace

std::vector<std::uint8_t> inside_samples(const TriMesh& mesh, const std::array<Index, 3>& size,
                                         const std::function<Vec3(const Vec3& position)>& index) {
  require(size[0] > 0 && size[1] > 0 && size[2] > 0, "inside_samples: grid of ", size[0], " x ",
          size[1], " x ", size[2]);
  std::vector<Vec3> vertices(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    vertices[static_cast<std::size_t>(v)] = index(mesh.points.row(v));
  Rows rows(static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]));
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const auto at = [&](int k) { return vertices[static_cast<std::size_t>(mesh.triangles(t, k))]; };
    add_crossings({at(0), at(1), at(2)}, size, rows);
  }
  // a mirrored map turns every crossing round: then inside counts negative
  std::vector<std::uint8_t> inside(rows.size() * static_cast<std::size_t>(size[0]), 0);
  parallel_for(static_cast<std::int64_t>(rows.size()), [&](Index r) {
    auto& crossings = rows[static_cast<std::size_t>(r)];
    std::sort(crossings.begin(), crossings.end());
    int winding = 0;
    for (std::size_t c = 0; c + 1 < crossings.size(); ++c) {
      winding += crossings[c].step;
      if (winding == 0) continue;
      const double last = size[0] - 1;
      const auto from = static_cast<Index>(std::ceil(std::clamp(crossings[c].x, 0.0, last + 1.0)));
      const auto to = static_cast<Index>(std::floor(std::clamp(crossings[c + 1].x, -1.0, last)));
      for (Index i = from; i <= to; ++i)
        inside[static_cast<std::size_t>(r) * static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(i)] = 1;
    }
  });
  return inside;
}

}  // namespace coxa
