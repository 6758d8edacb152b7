#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/segment/border_profile.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

const BorderBrightness kT1{180.0, 20.0, 45.0, 8.0};
constexpr double kFat = 200.0, kMuscle = 70.0;

/// Marrow, a dark band from `outer` - `band` to `outer`, `outside`: means over voxels of `voxel` mm
/// at a random offset, joined linearly, as an image gives them.
VecX imaged(double outer, double band, double outside, double voxel, Rng& rng, double noise) {
  const ProfileGrid grid = BorderModel::border_grid();
  const double offset = rng.uniform(0.0, voxel);
  const auto brightness = [&](double s) {
    return s < outer - band ? kT1.marrow : s < outer ? kT1.cortex : outside;
  };
  constexpr int kVoxels = 40, kFine = 50;
  std::vector<double> means;
  for (int v = 0; v < kVoxels; ++v) {
    double sum = 0.0;
    for (int i = 0; i < kFine; ++i)
      sum += brightness(-15.0 * voxel + offset + voxel * (v + (i + 0.5) / kFine));
    means.push_back(sum / kFine + noise * rng.normal());
  }
  VecX profile(grid.n);
  for (Index i = 0; i < grid.n; ++i) {
    const double at = std::clamp((grid.at(i) - offset) / voxel + 14.5, 0.0, kVoxels - 1.001);
    const auto v = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(v);
    profile[i] = (1.0 - share) * means[v] + share * means[v + 1];
  }
  return profile;
}

/// Mean error of the border over many offsets.
double bias(double band, double outside, double voxel, double noise, const BandPrior& prior = {}) {
  Rng rng(7);
  const BorderModel model(kT1, 0.5 * voxel);
  double sum = 0.0;
  constexpr int kTries = 60;
  for (int i = 0; i < kTries; ++i) {
    const double outer = rng.uniform(-0.8, 0.8);
    sum += model.fit(imaged(outer, band, outside, voxel, rng, noise), prior).outer - outer;
  }
  return sum / kTries;
}

}  // namespace

TEST(BorderModel, FindsTheBorderOfABandOfTwoVoxelsWithoutBias) {
  for (const double voxel : {0.6, 0.8, 1.0}) {
    for (const double band : {1.6, 2.1, 3.2}) {
      if (band < 2.0 * voxel) continue;
      for (const double outside : {kMuscle, kFat}) {
        for (const double noise : {0.0, 0.5 * kT1.noise})
          EXPECT_LT(std::abs(bias(band, outside, voxel, noise)), 0.05)
              << voxel << " " << band << " " << outside << " " << noise;
      }
    }
  }
}

TEST(BorderModel, WidthKnownBeforehandTellsABandOfAVoxel) {
  for (const double voxel : {0.6, 0.8, 1.0}) {
    for (const double band : {0.8, 1.2}) {
      for (const double outside : {kMuscle, kFat})
        EXPECT_LT(std::abs(bias(band, outside, voxel, 4.0, {band, 0.1})), 0.05)
            << voxel << " " << band << " " << outside;
    }
  }
}

TEST(BorderModel, PriorDoesNotNarrowABandMuchWider) {
  Rng rng(3);
  const BorderModel model(kT1, 0.4);
  const BorderFit fit = model.fit(imaged(0.3, 3.4, kFat, 0.8, rng, 2.0), {1.2, 0.3});
  EXPECT_NEAR(fit.band, 3.4, 0.15);
  EXPECT_NEAR(fit.inner, -3.1, 0.15);
}

TEST(BorderModel, DeviationGrowsWithTheVoxel) {
  Rng rng(3);
  const auto deviation = [&](double voxel) {
    return BorderModel(kT1, 0.5 * voxel)
        .fit(imaged(0.0, 1.5, kFat, voxel, rng, 4.0))
        .outer_deviation;
  };
  EXPECT_LT(deviation(0.6), 0.5 * deviation(2.0));
}

TEST(BorderModel, ShiftOfAnIdenticalProfileIsFoundExactly) {
  const ProfileGrid grid = BorderModel::border_grid();
  const auto profile = [&](double outer) {
    VecX values(grid.n);
    for (Index i = 0; i < grid.n; ++i) {
      const auto past = [&](double at) {
        return 0.5 * std::erfc(-(grid.at(i) - at) / (std::sqrt(2.0) * 0.4));
      };
      values[i] = 180.0 + (20.0 - 180.0) * past(outer - 1.7) + (200.0 - 20.0) * past(outer);
    }
    return values;
  };
  const BorderModel model(kT1, 0.4);
  for (const double outer : {-1.31, -0.4, 0.0, 0.77, 1.9}) {
    const BorderFit fit = model.fit(profile(outer));
    EXPECT_NEAR(fit.outer, outer, 0.01);
    EXPECT_NEAR(fit.band, 1.7, 0.02);
    EXPECT_LT(fit.misfit, 1e-3);
  }
}

TEST(BorderModel, RefusesNonsense) {
  EXPECT_THROW(BorderModel(kT1, 0.0), Error);
  EXPECT_THROW(BorderModel({180.0, 20.0, 45.0, 0.0}, 0.4), Error);
  EXPECT_THROW(BorderModel(kT1, 0.4, {0.0, 0.25, 65}), Error);
}

}  // namespace coxa::segment
