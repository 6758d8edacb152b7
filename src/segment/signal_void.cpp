#include "signal_void.h"

#include <coxa/geom/median.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// mm, of the grid that is looked at.
constexpr double kGrid = 3.0;
/// Of the median brightness inside the bones: what is darker gives no signal. Noise is below,
/// marrow with suppressed fat, as compared with itself, above.
constexpr double kDark = 0.2;
/// Grid points to every side that are all dark about a place within a void: 12 mm across.
constexpr Index kReach = 2;

/// A grid about the bone.
Volume grid_around(const TriMesh& bone) {
  Volume grid;
  grid.spacing = Vec3::Constant(kGrid);
  grid.origin = bone.points.colwise().minCoeff().transpose();
  const Vec3 extent = bone.points.colwise().maxCoeff().transpose() - grid.origin;
  for (std::size_t a = 0; a < 3; ++a)
    grid.size[a] = static_cast<Index>(std::ceil(extent[static_cast<Index>(a)] / kGrid)) + 1;
  return grid;
}

/// The grid with the image's values inside the bone; NaN outside of it and of the view.
Volume values_inside(const TriMesh& bone, const Volume& image) {
  Volume grid = grid_around(bone);
  const auto inside = inside_samples(bone, grid.size, [&](const Vec3& p) { return grid.index(p); });
  grid.values.assign(inside.size(), static_cast<float>(kNaN));
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const auto at = static_cast<std::size_t>(grid.offset(i, j, k));
        if (inside[at] != 0)
          grid.values[at] = static_cast<float>(sample(image, grid.position(Vec3(i, j, k))));
      }
  return grid;
}

double median_of(const std::vector<Volume>& grids) {
  std::vector<double> values;
  for (const Volume& grid : grids)
    std::copy_if(grid.values.begin(), grid.values.end(), std::back_inserter(values),
                 [](float v) { return !std::isnan(v); });
  return values.empty() ? 0.0 : median(values);
}

/// Whether all about a place of the grid is inside and dark.
bool dark_around(const Volume& grid, Index i, Index j, Index k, double dark) {
  for (Index c = k - kReach; c <= k + kReach; ++c)
    for (Index b = j - kReach; b <= j + kReach; ++b)
      for (Index a = i - kReach; a <= i + kReach; ++a) {
        const float value = grid.values[static_cast<std::size_t>(grid.offset(a, b, c))];
        if (!(value < dark)) return false;
      }
  return true;
}

double void_in(const Volume& grid, double dark) {
  double count = 0.0;
  for (Index k = kReach; k < grid.size[2] - kReach; ++k)
    for (Index j = kReach; j < grid.size[1] - kReach; ++j)
      for (Index i = kReach; i < grid.size[0] - kReach; ++i)
        count += dark_around(grid, i, j, k, dark) ? 1.0 : 0.0;
  return count * std::pow(kGrid, 3) / 1000.0;
}

}  // namespace

double signal_void(const std::vector<TriMesh>& bones, std::span<const PreparedImage> images) {
  double least = kInfinity;
  for (const PreparedImage& image : images) {
    std::vector<Volume> grids;
    for (const TriMesh& bone : bones) grids.push_back(values_inside(bone, image.volume));
    const double dark = kDark * median_of(grids);
    double here = 0.0;
    for (const Volume& grid : grids) here += void_in(grid, dark);
    least = std::min(least, here);
  }
  return least;
}

}  // namespace coxa::segment
