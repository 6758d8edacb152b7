#pragma once

#include <coxa/core/types.h>

#include <span>
#include <vector>

namespace coxa {

/// Regular samples of one layer z = constant, x fastest, mm in the grid's own axes.
struct LayerGrid {
  Index nx = 0, ny = 0;
  double x0 = 0.0, y0 = 0.0, dx = 1.0, dy = 1.0;
  std::size_t size() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
};

/// Signed distance (negative inside) of a closed surface on layers, exact within `band` of it.
class LayeredSurface {
 public:
  /// @param points V×3, mm in the grid's axes  @param values one per vertex, interpolated to
  /// samples
  LayeredSurface(Points points, Triangles triangles, VecX values, double band);

  /// @param distances grid.size() signed distances, cut at ±band
  /// @param values    grid.size() vertex values at the nearest point; unchanged beyond the band
  void rasterise(const LayerGrid& grid, double z, std::span<double> distances,
                 std::span<double> values) const;

 private:
  void lower_distances(const LayerGrid& grid, double z, Index triangle, std::span<double> squared,
                       std::span<double> values) const;
  void flip_inside(const LayerGrid& grid, double z, std::span<double> distances) const;

  Points points_;
  Triangles triangles_;
  VecX values_;
  double band_;
};

}  // namespace coxa
