#include "phantom_layer.h"

#include <coxa/geom/closest_point.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace coxa {
namespace {

/// Samples with low <= x0 + i dx <= high, as a half-open range within [0, n).
std::pair<Index, Index> sample_range(double low, double high, double x0, double dx, Index n) {
  const double first = std::ceil((low - x0) / dx), last = std::floor((high - x0) / dx);
  return {static_cast<Index>(std::clamp(first, 0.0, static_cast<double>(n))),
          static_cast<Index>(std::clamp(last + 1.0, 0.0, static_cast<double>(n)))};
}

}  // namespace

LayeredSurface::LayeredSurface(Points points, Triangles triangles, VecX values, double band)
    : points_(std::move(points)),
      triangles_(std::move(triangles)),
      values_(std::move(values)),
      band_(band) {}

void LayeredSurface::lower_distances(const LayerGrid& grid, double z, Index triangle,
                                     std::span<double> squared, std::span<double> values) const {
  const Index ia = triangles_(triangle, 0), ib = triangles_(triangle, 1),
              ic = triangles_(triangle, 2);
  const Vec3 a = points_.row(ia), b = points_.row(ib), c = points_.row(ic);
  const Vec3 low = a.cwiseMin(b).cwiseMin(c).array() - band_;
  const Vec3 high = a.cwiseMax(b).cwiseMax(c).array() + band_;
  if (z < low[2] || z > high[2]) return;
  const auto [i_begin, i_end] = sample_range(low[0], high[0], grid.x0, grid.dx, grid.nx);
  const auto [j_begin, j_end] = sample_range(low[1], high[1], grid.y0, grid.dy, grid.ny);
  const Vec3 normal = (b - a).cross(c - a).stableNormalized();
  for (Index j = j_begin; j < j_end; ++j) {
    for (Index i = i_begin; i < i_end; ++i) {
      const Vec3 p(grid.x0 + i * grid.dx, grid.y0 + j * grid.dy, z);
      const auto s = static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx) +
                     static_cast<std::size_t>(i);
      const double height = normal.dot(p - a);
      if (height * height >= squared[s]) continue;
      const TrianglePoint nearest = closest_point_on_triangle(p, a, b, c);
      if (nearest.squared_distance >= squared[s]) continue;
      squared[s] = nearest.squared_distance;
      values[s] = nearest.barycentric.dot(Vec3(values_[ia], values_[ib], values_[ic]));
    }
  }
}

/// Even-odd rule along each row; edges are cut in the order of their vertex numbers, so that both
/// triangles of an edge find the same crossing to the bit.
void LayeredSurface::flip_inside(const LayerGrid& grid, double z,
                                 std::span<double> distances) const {
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(grid.ny));
  for (Index t = 0; t < triangles_.rows(); ++t) {
    Vec2 cut[2];
    int n_cuts = 0;
    for (int e = 0; e < 3; ++e) {
      const auto [i, j] = std::minmax(triangles_(t, e), triangles_(t, (e + 1) % 3));
      if ((points_(i, 2) >= z) == (points_(j, 2) >= z)) continue;
      const double s = (z - points_(i, 2)) / (points_(j, 2) - points_(i, 2));
      cut[n_cuts++] = (points_.row(i) + s * (points_.row(j) - points_.row(i))).head<2>();
    }
    if (n_cuts != 2) continue;
    // the same end first, whichever triangle looks at the pair: rows compare with both ends alike
    const double y_low = std::min(cut[0][1], cut[1][1]), y_high = std::max(cut[0][1], cut[1][1]);
    const auto [j_begin, j_end] = sample_range(y_low, y_high, grid.y0, grid.dy, grid.ny);
    for (Index j = j_begin; j < j_end; ++j) {
      const double y = grid.y0 + j * grid.dy;
      if ((cut[0][1] >= y) == (cut[1][1] >= y)) continue;
      const double s = (y - cut[0][1]) / (cut[1][1] - cut[0][1]);
      crossings[static_cast<std::size_t>(j)].push_back(cut[0][0] + s * (cut[1][0] - cut[0][0]));
    }
  }
  for (Index j = 0; j < grid.ny; ++j) {
    std::vector<double>& row = crossings[static_cast<std::size_t>(j)];
    std::sort(row.begin(), row.end());
    for (std::size_t c = 0; c + 1 < row.size(); c += 2) {
      const auto [begin, end] = sample_range(row[c], row[c + 1], grid.x0, grid.dx, grid.nx);
      for (Index i = begin; i < end; ++i) {
        double& d = distances[static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx) +
                              static_cast<std::size_t>(i)];
        d = -std::abs(d);
      }
    }
  }
}

void LayeredSurface::rasterise(const LayerGrid& grid, double z, std::span<double> distances,
                               std::span<double> values) const {
  std::fill(distances.begin(), distances.end(), band_ * band_);
  for (Index t = 0; t < triangles_.rows(); ++t) lower_distances(grid, z, t, distances, values);
  for (double& d : distances) d = std::sqrt(d);
  flip_inside(grid, z, distances);
}

}  // namespace coxa
