#include <coxa/segment/segment.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "toy.h"

/// Every option has an effect.
namespace coxa::segment {
namespace {

const toy::Egg kEgg{1.5, -1.0};

const Volume& image() {
  static const Volume volume =
      toy::image_of(toy::egg_surface(kEgg, 3), {.spacing = Vec3::Constant(2.0)});
  return volume;
}
const shape::Atlas& atlas() {
  static const shape::Atlas a = toy::atlas();
  return a;
}

SegmentResult run(const SegmentOptions& o) {
  shape::Landmarks marks = toy::landmarks_of(kEgg);
  marks.at("mark_2") += Vec3(0, 4, 0);
  return segment({image()}, atlas(), Side::right, marks, o);
}

Points points(SegmentOptions o) {
  o.structures = {"egg"};
  return run(o).surfaces.at("egg").mesh.points;
}

const Points& default_points() {
  static const Points p = points({});
  return p;
}

std::string refusal(SegmentOptions o) {
  if (o.structures.size() == 4) o.structures = {"egg"};
  try {
    run(o);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST(SegmentOptions, EveryForceWeightChangesTheResult) {
  EXPECT_NE(points({.weights = {.image = 3.0}}), default_points());
  EXPECT_NE(points({.weights = {.shape = 3.0}}), default_points());
  EXPECT_NE(points({.weights = {.smoothing = 5.0}}), default_points());
  EXPECT_NE(points({.weights = {.memory = 5.0}}), default_points());
}

TEST(SegmentOptions, SearchAndIterationOptionsChangeTheResult) {
  EXPECT_NE(points({.landmark_error = 10.0}), default_points());
  EXPECT_NE(points({.search_range = 9.0}), default_points());
  EXPECT_NE(points({.gradient_weight = 0.0}), default_points());
  EXPECT_NE(points({.iterations = 2}), default_points());
  EXPECT_NE(points({.tolerance = 0.5}), default_points());
  EXPECT_NE(points({.correct_bias = false}), default_points());
}

TEST(SegmentOptions, ContrastIsTakenAsGiven) {
  SegmentOptions o{.structures = {"egg"}, .contrast = "bright", .minimum_quality = 0.0};
  EXPECT_EQ(run(o).contrasts.front(), "bright");
  o.contrast = "ct";
  EXPECT_NE(refusal(o).find("no 'ct' profiles for egg"), std::string::npos);
}

TEST(SegmentOptions, MinimumQualityRefuses) {
  EXPECT_NE(refusal({.minimum_quality = 1.0}).find("quality"), std::string::npos);
  EXPECT_EQ(refusal({.minimum_quality = 0.5}), "");
}

TEST(SegmentOptions, ValuesOutOfRangeAreNamed) {
  EXPECT_NE(refusal({.landmark_error = -1.0}).find("landmark_error"), std::string::npos);
  EXPECT_NE(refusal({.search_range = 0.0}).find("search_range"), std::string::npos);
  EXPECT_NE(refusal({.weights = {.image = -1.0}}).find("weights"), std::string::npos);
  EXPECT_NE(refusal({.gradient_weight = -1.0}).find("gradient_weight"), std::string::npos);
  EXPECT_NE(refusal({.minimum_gap = -1.0}).find("minimum_gap"), std::string::npos);
  EXPECT_NE(refusal({.iterations = 0}).find("iterations"), std::string::npos);
  EXPECT_NE(refusal({.tolerance = -1.0}).find("tolerance"), std::string::npos);
  EXPECT_NE(refusal({.minimum_quality = 2.0}).find("minimum_quality"), std::string::npos);
  EXPECT_NE(refusal({.structures = {"nose"}}).find("nose"), std::string::npos);
}

}  // namespace coxa::segment
