#include <coxa/image/volume.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace coxa {
namespace {

/// Slack of the box of voxel centres, in voxels: positions computed from indices carry rounding.
constexpr double kIndexSlack = 1e-6;

bool inside_box(const Volume& volume, const Vec3& index) {
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -kIndexSlack && index[a] <= volume.size[a] - 1 + kIndexSlack)) return false;
  }
  return true;
}

/// Trilinear value at a grid index; each coordinate is clamped to the box of voxel centres.
double value_at_index(const Volume& volume, const Vec3& index) {
  Index low[3], high[3];
  double fraction[3];
  for (int a = 0; a < 3; ++a) {
    const Index last = volume.size[a] - 1;
    const double x = std::clamp(index[a], 0.0, static_cast<double>(last));
    low[a] = std::min(static_cast<Index>(x), last);
    high[a] = std::min(low[a] + 1, last);
    fraction[a] = x - low[a];
  }
  const float* values = volume.values.data();
  const auto along_x = [&](Index j, Index k) {
    const float* row = values + volume.offset(0, j, k);
    return row[low[0]] + fraction[0] * (static_cast<double>(row[high[0]]) - row[low[0]]);
  };
  const double near_low = along_x(low[1], low[2]), near_high = along_x(high[1], low[2]);
  const double far_low = along_x(low[1], high[2]), far_high = along_x(high[1], high[2]);
  const double near = near_low + fraction[1] * (near_high - near_low);
  const double far = far_low + fraction[1] * (far_high - far_low);
  return near + fraction[2] * (far - near);
}

std::vector<double> gaussian_kernel(double sigma_voxels) {
  const auto radius = static_cast<Index>(std::ceil(4.0 * sigma_voxels));
  std::vector<double> half(static_cast<std::size_t>(radius) + 1);
  for (Index t = 0; t <= radius; ++t) {
    half[static_cast<std::size_t>(t)] = std::exp(-0.5 * t * t / (sigma_voxels * sigma_voxels));
  }
  return half;
}

/// One row (fixed j, k) of the convolution along `axis`; weights are renormalised at the borders.
void convolve_row(const Volume& in, int axis, const std::vector<double>& half, Index j, Index k,
                  std::span<float> out) {
  const auto radius = static_cast<Index>(half.size()) - 1;
  const Index n = in.size[axis];
  const Index nx = in.size[0];
  std::vector<double> sum(static_cast<std::size_t>(nx), 0.0), weight(sum);
  for (Index t = -radius; t <= radius; ++t) {
    const double w = half[static_cast<std::size_t>(std::abs(t))];
    const Index jj = axis == 1 ? j + t : j, kk = axis == 2 ? k + t : k;
    if (axis != 0 && (axis == 1 ? jj < 0 || jj >= n : kk < 0 || kk >= n)) continue;
    const Index shift = axis == 0 ? t : 0;
    const float* row = in.values.data() + in.offset(0, jj, kk);
    const Index begin = std::max<Index>(0, -shift), end = std::min<Index>(nx, nx - shift);
    for (Index i = begin; i < end; ++i) {
      sum[static_cast<std::size_t>(i)] += w * row[i + shift];
      weight[static_cast<std::size_t>(i)] += w;
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) out[i] = static_cast<float>(sum[i] / weight[i]);
}

}  // namespace

bool in_view(const Volume& volume, const Vec3& p, double margin) {
  const Vec3 index = volume.index(p);
  for (int a = 0; a < 3; ++a) {
    const double slack = margin / volume.spacing[a] - kIndexSlack;
    if (!(index[a] >= slack && index[a] <= volume.size[a] - 1 - slack)) return false;
  }
  return true;
}

double sample(const Volume& volume, const Vec3& p) {
  const Vec3 index = volume.index(p);
  return inside_box(volume, index) ? value_at_index(volume, index) : kNaN;
}

double sample_clamped(const Volume& volume, const Vec3& p) {
  return value_at_index(volume, volume.index(p));
}

Vec3 sample_gradient(const Volume& volume, const Vec3& p) {
  const Vec3 index = volume.index(p);
  if (!inside_box(volume, index)) return Vec3::Constant(kNaN);
  Vec3 gradient = Vec3::Zero();
  for (int a = 0; a < 3; ++a) {
    Vec3 low = index, high = index;
    low[a] = std::max(index[a] - 0.5, 0.0);
    high[a] = std::min(index[a] + 0.5, volume.size[a] - 1.0);
    const double distance = (high[a] - low[a]) * volume.spacing[a];
    if (distance <= 0.0) continue;  // a single layer has no gradient across it
    gradient[a] = (value_at_index(volume, high) - value_at_index(volume, low)) / distance;
  }
  return volume.direction * gradient;
}

Volume smoothed(const Volume& volume, double sigma_mm) {
  require(sigma_mm >= 0.0, "standard deviation of smoothing must be at least 0 mm, got ", sigma_mm);
  Volume result = volume;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma_voxels = sigma_mm / volume.spacing[axis];
    if (sigma_voxels < 1e-3 || volume.size[axis] < 2) continue;
    const std::vector<double> half = gaussian_kernel(sigma_voxels);
    const Volume source = result;
    const Index nx = volume.size[0], ny = volume.size[1];
    parallel_for(static_cast<std::int64_t>(ny) * volume.size[2], [&](Index row) {
      const Index j = row % ny, k = row / ny;
      const auto begin = static_cast<std::size_t>(source.offset(0, j, k));
      convolve_row(source, axis, half, j, k,
                   std::span(result.values).subspan(begin, static_cast<std::size_t>(nx)));
    });
  }
  return result;
}

Volume resampled_isotropic(const Volume& volume, double spacing_mm) {
  require(spacing_mm > 0.0, "voxel size must be positive, got ", spacing_mm, " mm");
  Volume result;
  for (int a = 0; a < 3; ++a) {
    const double extent = (volume.size[a] - 1) * volume.spacing[a];
    result.size[a] = static_cast<Index>(std::floor(extent / spacing_mm + kIndexSlack)) + 1;
  }
  result.spacing = Vec3::Constant(spacing_mm);
  result.origin = volume.origin;
  result.direction = volume.direction;
  result.values.resize(static_cast<std::size_t>(result.n_voxels()));
  const Index ny = result.size[1];
  const Vec3 ratio = result.spacing.cwiseQuotient(volume.spacing);
  parallel_for(static_cast<std::int64_t>(ny) * result.size[2], [&](Index row) {
    const Index j = row % ny, k = row / ny;
    float* out = result.values.data() + result.offset(0, j, k);
    for (Index i = 0; i < result.size[0]; ++i) {
      out[i] = static_cast<float>(value_at_index(volume, ratio.cwiseProduct(Vec3(i, j, k))));
    }
  });
  return result;
}

}  // namespace coxa
