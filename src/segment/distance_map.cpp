#include <coxa/segment/distance_map.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <array>
#include <cmath>
#include <limits>

namespace coxa::segment {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Room for one line of a grid.
struct Line {
  explicit Line(Index n) : value(n), squared(n), from(n), parabola(n) {}
  VecX value, squared;
  VecX from;                 ///< where each parabola of the lower envelope takes over
  Eigen::VectorXi parabola;  ///< the place of its apex
};

/// Least over the line of value[j] + (step (i - j))²: the lower envelope of parabolas.
void update_line(Line& line, Index n, double step) {
  Index count = 0;
  const double unit = step * step;
  for (Index q = 0; q < n; ++q) {
    if (!std::isfinite(line.value[q])) continue;
    const double high = line.value[q] + unit * q * q;
    double start = -kInfinity;
    while (count > 0) {
      const Index p = line.parabola[count - 1];
      start = (high - line.value[p] - unit * p * p) / (2.0 * unit * (q - p));
      if (start > line.from[count - 1]) break;
      --count;
    }
    line.from[count] = count == 0 ? -kInfinity : start;
    line.parabola[count++] = q;
  }
  Index k = 0;
  for (Index i = 0; i < n; ++i) {
    if (count == 0) {
      line.squared[i] = kInfinity;
      continue;
    }
    while (k + 1 < count && line.from[k + 1] < i) ++k;
    const double off = i - line.parabola[k];
    line.squared[i] = line.value[line.parabola[k]] + unit * off * off;
  }
}

/// All lines of the grid along one axis.
void update_axis(std::vector<float>& squared, const Volume& grid, std::size_t axis) {
  const std::array<std::int64_t, 3> strides{1, grid.size[0],
                                            std::int64_t{grid.size[0]} * grid.size[1]};
  const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
  const Index n = grid.size[axis];
  parallel_for(grid.size[w], [&](Index b) {
    Line line(n);
    for (Index a = 0; a < grid.size[u]; ++a) {
      const std::int64_t first = a * strides[u] + b * strides[w];
      const auto at = [&](Index i) { return static_cast<std::size_t>(first + i * strides[axis]); };
      for (Index i = 0; i < n; ++i) line.value[i] = squared[at(i)];
      update_line(line, n, grid.spacing[static_cast<Index>(axis)]);
      for (Index i = 0; i < n; ++i) squared[at(i)] = static_cast<float>(line.squared[i]);
    }
  });
}

}  // namespace

std::vector<float> distances_to(const Mask& mask, const Volume& grid) {
  require(static_cast<std::int64_t>(mask.size()) == grid.n_voxels(), "a mask of ", mask.size(),
          " voxels does not fit a grid of ", grid.n_voxels());
  std::vector<float> squared(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) squared[i] = mask[i] != 0 ? 0.0F : kFar;
  for (std::size_t axis = 0; axis < 3; ++axis) update_axis(squared, grid, axis);
  for (float& value : squared) value = std::sqrt(value);
  return squared;
}

std::vector<float> depths_in(const Mask& mask, const Volume& grid) {
  Mask rest(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) rest[i] = mask[i] == 0;
  std::vector<float> depths = distances_to(rest, grid);
  const std::vector<float> outside = distances_to(mask, grid);
  for (std::size_t i = 0; i < depths.size(); ++i)
    if (mask[i] == 0) depths[i] = -outside[i];
  return depths;
}

}  // namespace coxa::segment
