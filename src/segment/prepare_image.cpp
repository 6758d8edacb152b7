#include <coxa/segment/profile_search.h>

#include <coxa/core/error.h>
#include <coxa/image/intensity.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// Slices thicker than this show no cartilage and hardly a femoral neck.
constexpr double kLargestSpacing = 10.0;  // mm
/// A hip is about 60 mm of joint and neck along every axis; a localizer or a single slice is not
/// enough.
constexpr double kLeastExtent = 40.0;  // mm
constexpr Index kLeastSlices = 8;

void check(const Volume& volume) {
  require(
      volume.n_voxels() > 0 && static_cast<std::int64_t>(volume.values.size()) == volume.n_voxels(),
      "the image has no voxels, or its values do not match its size");
  for (int a = 0; a < 3; ++a) {
    const double extent = volume.size[a] * volume.spacing[a];
    require(volume.size[a] >= kLeastSlices, "the image has only ", volume.size[a],
            " voxels along axis ", a + 1, " (least ", kLeastSlices,
            "): a localizer cannot be segmented");
    require(volume.spacing[a] <= kLargestSpacing, "the image's voxels are ", volume.spacing[a],
            " mm along axis ", a + 1, " (limit ", kLargestSpacing, " mm)");
    require(extent >= kLeastExtent, "the image covers only ", extent, " mm along axis ", a + 1,
            " (least ", kLeastExtent, " mm)");
  }
}

double intensity_range(const Volume& volume) {
  std::vector<float> values;
  // every value would do; a fixed stride keeps the sort short
  const std::int64_t stride = std::max<std::int64_t>(1, volume.n_voxels() / 200000);
  for (std::int64_t i = 0; i < volume.n_voxels(); i += stride) {
    const float value = volume.values[static_cast<std::size_t>(i)];
    if (std::isfinite(value)) values.push_back(value);
  }
  require(!values.empty(), "the image has no finite value");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return values[n * 98 / 100] - values[n * 2 / 100];
}

}  // namespace

PreparedImage prepare_image(const Volume& volume, bool correct_bias, const Monitor& monitor) {
  check(volume);
  PreparedImage image;
  require(intensity_range(volume) > 0.0, "the image is the same brightness everywhere");
  image.volume = correct_bias ? bias_corrected(volume, {}, monitor) : volume;
  image.intensity_range = intensity_range(image.volume);
  return image;
}

}  // namespace coxa::segment
