#include <coxa/image/volume.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace coxa {
namespace {

/// Oblique anisotropic grid filled with f(LPS position).
template <class F>
Volume make_volume(std::array<Index, 3> size, const F& f) {
  Volume volume;
  volume.size = size;
  volume.spacing = Vec3(0.8, 1.1, 3.0);
  volume.origin = Vec3(-40, 12, 7);
  volume.direction =
      (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-0.2, Vec3::UnitZ())).matrix();
  for (Index k = 0; k < size[2]; ++k) {
    for (Index j = 0; j < size[1]; ++j) {
      for (Index i = 0; i < size[0]; ++i) {
        volume.values.push_back(static_cast<float>(f(volume.position(Vec3(i, j, k)))));
      }
    }
  }
  return volume;
}

const Vec3 kSlope(0.7, -1.3, 0.4);
double linear(const Vec3& p) { return kSlope.dot(p) + 5.0; }

TEST(Volume, IndexInvertsPosition) {
  const Volume volume = make_volume({4, 5, 3}, linear);
  const Vec3 index(1.25, 3.5, 0.75);
  EXPECT_LT((volume.index(volume.position(index)) - index).norm(), 1e-12);
}
TEST(Volume, TrilinearSamplingIsExactOnLinearFunctions) {
  const Volume volume = make_volume({9, 8, 5}, linear);
  Rng rng(1);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = volume.position(Vec3(rng.uniform(0, 8), rng.uniform(0, 7), rng.uniform(0, 4)));
    EXPECT_NEAR(sample(volume, p), linear(p), 1e-4);  // float storage of values near 100
    EXPECT_NEAR(sample_clamped(volume, p), linear(p), 1e-4);
    EXPECT_LT((sample_gradient(volume, p) - kSlope).norm(), 1e-4);
  }
}
TEST(Volume, SampleGivesNanOutsideAndClampedTheNearestVoxel) {
  const Volume volume = make_volume({3, 3, 3}, linear);
  const Vec3 outside = volume.position(Vec3(-1, 1, 1));
  EXPECT_TRUE(std::isnan(sample(volume, outside)));
  EXPECT_TRUE(sample_gradient(volume, outside).array().isNaN().all());
  EXPECT_NEAR(sample_clamped(volume, outside),
              volume.values[static_cast<std::size_t>(volume.offset(0, 1, 1))], 1e-5);
  EXPECT_FALSE(std::isnan(sample(volume, volume.position(Vec3(2, 2, 2)))));
}
TEST(Volume, InViewRespectsTheMarginInMillimetres) {
  const Volume volume = make_volume({11, 11, 11}, linear);
  const Vec3 p = volume.position(Vec3(5, 5, 1));  // 3 mm from the first layer
  EXPECT_TRUE(in_view(volume, p));
  EXPECT_TRUE(in_view(volume, p, 2.9));
  EXPECT_FALSE(in_view(volume, p, 3.1));
  EXPECT_FALSE(in_view(volume, volume.position(Vec3(5, 5, -0.1))));
}
TEST(Volume, SingleLayerCanBeSampled) {
  const Volume volume = make_volume({4, 4, 1}, linear);
  const Vec3 p = volume.position(Vec3(1.5, 2.5, 0));
  EXPECT_NEAR(sample(volume, p), linear(p), 1e-4);
}
TEST(Volume, SmoothingKeepsConstantsAndBroadensAGaussianByItsVariance) {
  const Volume constant = make_volume({12, 9, 6}, [](const Vec3&) { return 3.5; });
  for (const float value : smoothed(constant, 2.0).values) EXPECT_NEAR(value, 3.5, 1e-6);

  const Vec3 centre = constant.position(Vec3(20, 15, 6));
  const auto gauss = [&](const Vec3& p, double sigma) {
    return std::exp(-0.5 * (p - centre).squaredNorm() / (sigma * sigma)) / std::pow(sigma, 3);
  };
  const Volume before =
      make_volume({41, 31, 13}, [&](const Vec3& p) { return 1e3 * gauss(p, 4.0); });
  const Volume after = smoothed(before, 3.0);
  const double expected = 1e3 * gauss(centre, 5.0);
  EXPECT_NEAR(sample(after, centre), expected, 0.02 * expected);  // cut at 4 sigma, coarse slices
}
TEST(Volume, SmoothingIsBitIdenticalForAnyThreadCount) {
  Rng rng(3);
  const Volume noise = make_volume({30, 20, 10}, [&](const Vec3&) { return rng.normal(); });
  const auto run = [&] { return smoothed(noise, 1.5).values; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(Volume, IsotropicResamplingKeepsFrameAndLinearValues) {
  const Volume volume = make_volume({9, 8, 5}, linear);
  const Volume result = resampled_isotropic(volume, 0.5);
  EXPECT_EQ(result.size, (std::array<Index, 3>{13, 16, 25}));
  for (Index k = 0; k < result.size[2]; k += 3) {
    const Vec3 p = result.position(Vec3(2, 3, k));
    EXPECT_NEAR(result.values[static_cast<std::size_t>(result.offset(2, 3, k))], linear(p), 1e-4);
  }
}
TEST(Volume, RefusesImpossibleOptions) {
  const Volume volume = make_volume({3, 3, 3}, linear);
  EXPECT_THROW(smoothed(volume, -1.0), Error);
  EXPECT_THROW(resampled_isotropic(volume, 0.0), Error);
}

}  // namespace
}  // namespace coxa
