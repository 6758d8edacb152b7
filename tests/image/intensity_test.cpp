#include <coxa/image/intensity.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

namespace coxa {
namespace {

/// Three tissues in air, 60 mm wide, in which every place knows its tissue.
struct Scene {
  Volume image;
  std::vector<int> tissue;  ///< 0 air, 1 muscle, 2 fat, 3 marrow
};

double shading(const Vec3& p) {
  return std::exp(0.35 * std::sin(p[0] / 45.0) - 0.25 * std::pow(p[2] / 45.0, 2));
}

Scene make_scene(double bias) {
  Scene scene;
  scene.image.size = {40, 36, 30};
  scene.image.spacing = Vec3(2.0, 2.0, 3.0);
  scene.image.origin = Vec3(-39, -35, -43.5);
  Rng rng(5);
  for (Index k = 0; k < 30; ++k) {
    for (Index j = 0; j < 36; ++j) {
      for (Index i = 0; i < 40; ++i) {
        const Vec3 p = scene.image.position(Vec3(i, j, k));
        const bool body = std::hypot(p[0] / 38.0, p[1] / 34.0) < 1.0;
        const double pattern =
            std::sin(p[0] / 6.0) + std::sin(p[1] / 5.0 + 1.0) + std::sin(p[2] / 9.0);
        const int tissue = !body ? 0 : pattern > 0.8 ? 3 : pattern > -0.2 ? 2 : 1;
        const double level = tissue == 0 ? 0.0 : tissue == 1 ? 100.0 : tissue == 2 ? 330.0 : 270.0;
        const double clean = level * std::pow(shading(p), bias);
        scene.tissue.push_back(tissue);
        scene.image.values.push_back(
            static_cast<float>(std::hypot(clean + 4.0 * rng.normal(), 4.0 * rng.normal())));
      }
    }
  }
  return scene;
}

/// Standard deviation over mean within one tissue.
double variation(const Scene& scene, const Volume& image, int tissue) {
  double n = 0.0, sum = 0.0, square = 0.0;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (scene.tissue[i] != tissue) continue;
    n += 1.0;
    sum += image.values[i];
    square += static_cast<double>(image.values[i]) * image.values[i];
  }
  return std::sqrt(square / n - std::pow(sum / n, 2)) / (sum / n);
}

TEST(Intensity, PercentilesInterpolateBetweenVoxels) {
  Volume volume;
  volume.values = {3, 1, 2, 5, 4};
  const std::vector<double> expected = {1.0, 3.0, 4.6, 5.0};
  const std::vector<double> got = intensity_percentiles(volume, {0.0, 0.5, 0.9, 1.0});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(got[i], expected[i], 1e-6);
  EXPECT_THROW(intensity_percentiles(volume, {1.5}), Error);
  EXPECT_THROW(intensity_percentiles(Volume{}, {0.5}), Error);
}
TEST(Intensity, ThresholdPartsAirFromBody) {
  const Scene scene = make_scene(1.0);
  const double threshold = foreground_threshold(scene.image);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < scene.tissue.size(); ++i)
    wrong += (scene.image.values[i] > threshold) != (scene.tissue[i] > 0);
  EXPECT_LT(static_cast<double>(wrong), 0.01 * static_cast<double>(scene.tissue.size()));
  Volume constant = scene.image;
  std::fill(constant.values.begin(), constant.values.end(), 7.0F);
  EXPECT_THROW(foreground_threshold(constant), Error);
}
TEST(Intensity, NormalisationDoesNotDependOnTheScannersScale) {
  const Scene scene = make_scene(0.0);
  Volume scaled = scene.image;
  for (float& value : scaled.values) value *= 7.5F;
  const Volume a = normalised(scene.image), b = normalised(scaled);
  for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1e-4);
  EXPECT_THROW(normalised(scene.image, 0.5, 0.5), Error);
}
TEST(BiasField, CorrectionMakesTissuesEven) {
  const Scene scene = make_scene(1.0);
  const Volume corrected = bias_corrected(scene.image);
  // muscle keeps its noise of 4 %
  for (int tissue = 1; tissue <= 3; ++tissue) {
    const double before = variation(scene, scene.image, tissue),
                 after = variation(scene, corrected, tissue);
    EXPECT_LT(after, 0.35 * before) << tissue;
  }
}
TEST(BiasField, FieldIsTheShadingAndKeepsTheMean) {
  const Scene scene = make_scene(1.0);
  const Volume field = bias_field(scene.image);
  double n = 0.0, mean = 0.0, square = 0.0, log_mean = 0.0;
  for (std::size_t i = 0; i < scene.tissue.size(); ++i) {
    if (scene.tissue[i] == 0) continue;
    const auto at = static_cast<Index>(i);
    const Vec3 p = scene.image.position(Vec3(at % 40, at / 40 % 36, at / 1440));
    const double difference = std::log(field.values[i]) - std::log(shading(p));
    n += 1.0;
    mean += difference;
    square += difference * difference;
    log_mean += std::log(static_cast<double>(field.values[i]));
  }
  EXPECT_LT(std::sqrt(square / n - std::pow(mean / n, 2)), 0.02);  // of a field with deviation 0.24
  EXPECT_NEAR(log_mean / n, 0.0, 0.02);
}
TEST(BiasField, LeavesAnEvenImageAlone) {
  const Volume field = bias_field(make_scene(0.0).image);
  const auto [low, high] = std::minmax_element(field.values.begin(), field.values.end());
  EXPECT_GT(*low, 0.97F);
  EXPECT_LT(*high, 1.03F);
}
TEST(BiasField, EveryOptionHasItsEffect) {
  const Scene scene = make_scene(1.0);
  const std::vector<float> usual = bias_field(scene.image).values;
  EXPECT_NE(bias_field(scene.image, {.working_voxel = 8.0}).values, usual);
  EXPECT_NE(bias_field(scene.image, {.degree = 1}).values, usual);
  EXPECT_NE(bias_field(scene.image, {.iterations = 1}).values, usual);
  EXPECT_NE(bias_field(scene.image, {.width = 0.4}).values, usual);
  EXPECT_NE(bias_field(scene.image, {.tolerance = 0.5}).values, usual);
  EXPECT_THROW(bias_field(scene.image, {.working_voxel = 0.0}), Error);
  EXPECT_THROW(bias_field(scene.image, {.degree = 7}), Error);
  EXPECT_THROW(bias_field(scene.image, {.iterations = 0}), Error);
  EXPECT_THROW(bias_field(scene.image, {.width = 0.0}), Error);
  EXPECT_THROW(bias_field(scene.image, {.tolerance = 0.0}), Error);
  EXPECT_THROW(bias_field(scene.image, {.working_voxel = 60.0}), Error);
}

TEST(BiasField, StopsWhenTheUserAsks) {
  const std::atomic<bool> stop = true;
  Monitor monitor;
  monitor.cancel_flag = &stop;
  EXPECT_THROW(bias_corrected(make_scene(0.4).image, {}, monitor), Error);
}
TEST(BiasField, IsBitIdenticalForAnyThreadCount) {
  const Scene scene = make_scene(1.0);
  const auto run = [&] { return bias_field(scene.image).values; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

}  // namespace
}  // namespace coxa
