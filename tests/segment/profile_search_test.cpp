#include <coxa/segment/profile_search.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

/// Plane border at z = `place`; below it is inside. Gain and offset as a scanner would apply them.
PreparedImage plane_image(double place, const Vec3& spacing = Vec3::Constant(1.0),
                          double gain = 1.0, double offset = 0.0) {
  PreparedImage image;
  Volume& v = image.volume;
  v.spacing = spacing;
  for (int a = 0; a < 3; ++a)
    v.size[static_cast<std::size_t>(a)] = static_cast<Index>(60.0 / spacing[a]) + 1;
  v.origin = Vec3::Constant(-30.0);
  for (std::int64_t k = 0; k < v.n_voxels(); ++k) {
    const Index slice = static_cast<Index>(k / (v.size[0] * v.size[1]));
    // a voxel is the mean over its thickness
    double mean = 0.0;
    for (int s = 0; s < 20; ++s) {
      const double z = v.origin.z() + spacing.z() * (slice + (s + 0.5) / 20.0 - 0.5);
      mean += toy::t1_value(z - place) / 20.0;
    }
    v.values.push_back(static_cast<float>(gain * mean + offset));
  }
  image.intensity_range = 140.0 * gain;
  return image;
}

struct Probe {
  Points positions{1, 3}, normals{1, 3};
  Probe(double x, double z) {
    positions << x, 0.0, z;
    normals << 0.0, 0.0, 1.0;
  }
};

ProfileMatch match(const PreparedImage& image, const Probe& probe,
                   const ProfileSearch& search = {}) {
  const auto reference = toy::profiles("t1", 1, toy::t1_value);
  return best_match(score_profiles(image, probe.positions, probe.normals, reference, search),
                    reference.reliability);
}

}  // namespace

TEST(ProfileSearch, FindsAPlaneToAFractionOfAVoxel) {
  for (double place = -1.0; place <= 1.0; place += 0.17) {
    EXPECT_NEAR(match(plane_image(place), {0.0, 0.0}).shift[0], place, 0.12) << place;
  }
}

TEST(ProfileSearch, IsBlindToGainAndOffset) {
  const double plain = match(plane_image(0.7), {0.0, 0.0}).shift[0];
  EXPECT_NEAR(match(plane_image(0.7, Vec3::Constant(1.0), 3.0, 500.0), {0.0, 0.0}).shift[0], plain,
              1e-4);
}

TEST(ProfileSearch, FindsAPlaneBetweenThickSlices) {
  for (const double place : {-1.2, -0.4, 0.5, 1.1}) {
    EXPECT_NEAR(match(plane_image(place, {1.0, 1.0, 3.0}), {0.0, 0.0}).shift[0], place, 0.7)
        << place;
  }
}

TEST(ProfileSearch, SeesNothingOutsideTheImageAndSaysSo) {
  const ProfileMatch outside = match(plane_image(0.0), {40.0, 0.0});
  EXPECT_EQ(outside.seen[0], 0.0);
  EXPECT_EQ(outside.confidence[0], 0.0);
  EXPECT_EQ(outside.shift[0], 0.0);
  EXPECT_EQ(match(plane_image(0.0), {0.0, 0.0}).seen[0], 1.0);
}

TEST(ProfileSearch, HasLittleConfidenceWhereTheImageIsFlat) {
  PreparedImage image = plane_image(0.0);
  Rng rng(5);
  for (float& value : image.volume.values) value = static_cast<float>(100.0 + rng.normal());
  EXPECT_LT(match(image, {0.0, 0.0}).confidence[0], 0.15);
  EXPECT_GT(match(plane_image(0.0), {0.0, 0.0}).confidence[0], 0.8);
}

TEST(ProfileSearch, RangeLimitsHowFarABorderIsFound) {
  const PreparedImage image = plane_image(3.0);
  EXPECT_NEAR(match(image, {0.0, 0.0}, {.range = 5.0}).shift[0], 3.0, 0.15);
  EXPECT_LE(match(image, {0.0, 0.0}, {.range = 1.0}).shift[0], 1.0);
}

TEST(ProfileSearch, GradientWeightAndShiftPenaltyEnterTheScore) {
  const auto reference = toy::profiles("t1", 1, toy::t1_value);
  const Probe probe(0.0, 0.0);
  const auto scores = [&](const ProfileSearch& search) {
    return score_profiles(plane_image(0.0), probe.positions, probe.normals, reference, search);
  };
  const ProfileSearch plain{.gradient_weight = 0.0, .shift_penalty = 0.0};
  const ProfileScores a = scores(plain);
  EXPECT_EQ(a.score(0, a.n_each_way), a.correlation(0, a.n_each_way));
  const ProfileScores b = scores({.gradient_weight = 1.0, .shift_penalty = 0.0});
  EXPECT_GT(b.score(0, b.n_each_way), a.score(0, a.n_each_way) + 0.1);
  const ProfileScores c = scores({.gradient_weight = 0.0, .shift_penalty = 0.5});
  EXPECT_NEAR(c.score(0, 0), a.score(0, 0) - 0.5, 1e-12);
}

TEST(ProfileSearch, WindowAndImageSmoothingChangeTheCorrelation) {
  // another tissue begins 2 mm above the border: a narrow window hardly looks there
  PreparedImage image = plane_image(0.0);
  for (std::size_t i = 61u * 61u * 32u; i < image.volume.values.size(); ++i)
    image.volume.values[i] = 250.0f;
  const double wide = match(image, {0.0, 0.0}, {.range = 0.5, .window = 6.0}).correlation[0];
  const double narrow = match(image, {0.0, 0.0}, {.range = 0.5, .window = 1.5}).correlation[0];
  EXPECT_GT(narrow, wide + 0.1);
  // a smoothed image is compared with a smoothed reference
  PreparedImage smooth = plane_image(0.0);
  smooth.volume = smoothed(smooth.volume, 1.5);
  const double alike = match(smooth, {0.0, 0.0}, {.range = 0.5, .image_sigma = 1.5}).correlation[0];
  const double unlike =
      match(smooth, {0.0, 0.0}, {.range = 0.5, .image_sigma = 0.0}).correlation[0];
  EXPECT_GT(alike, unlike);
}

TEST(ProfileScores, NeighboursOutvoteAStrayVertex) {
  ProfileScores scores;
  scores.n_each_way = 2;
  scores.score = MatX::Zero(4, 5);
  scores.score.col(3).setConstant(1.0);
  scores.score(0, 3) = 0.0;
  scores.score(0, 0) = 1.2;
  scores.correlation = scores.score;
  Triangles neighbours(4, 3);
  neighbours << 1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2;
  const VecX reliability = VecX::Ones(4);
  EXPECT_LT(best_match(scores, reliability).shift[0], 0.0);
  update_smoothed(scores, neighbours, reliability, 1);
  EXPECT_NEAR(best_match(scores, reliability).shift[0], 0.5, 0.26);
}

TEST(ProfileScores, ASecondImageFillsWhatTheFirstDoesNotSee) {
  ProfileScores a, b;
  a.n_each_way = b.n_each_way = 1;
  a.score = MatX::Constant(2, 3, kNaN);
  a.score.row(0) << 0.0, 1.0, 0.0;
  b.score = MatX::Zero(2, 3);
  b.score.row(1) << 0.0, 0.0, 1.0;
  a.correlation = a.score;
  b.correlation = b.score;
  update_combined(a, b);
  EXPECT_EQ(a.score(0, 1), 0.5);
  EXPECT_EQ(a.score(1, 2), 1.0);
}

TEST(PrepareImage, RefusesALocalizerAThickStackAndAnEmptyImage) {
  Volume volume = plane_image(0.0).volume;
  EXPECT_NO_THROW(prepare_image(volume, false));
  Volume few = volume;
  few.size[2] = 5;
  few.values.resize(static_cast<std::size_t>(few.n_voxels()));
  EXPECT_THROW(prepare_image(few, false), Error);
  Volume thick = volume;
  thick.spacing.z() = 12.0;
  EXPECT_THROW(prepare_image(thick, false), Error);
  Volume dark = volume;
  std::fill(dark.values.begin(), dark.values.end(), 3.0f);
  EXPECT_THROW(prepare_image(dark, false), Error);
}

}  // namespace coxa::segment
