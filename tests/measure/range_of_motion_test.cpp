#include <coxa/measure/range_of_motion.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/motion/bone_frames.h>
#include <gtest/gtest.h>

#include "support/shapes.h"
#include "support/small_hip.h"

namespace coxa::measure {
namespace {

/// The small hip; a left one is its mirror image.
RomModel small_model(Side side = Side::right) {
  RomModel model;
  model.side = side;
  model.hip_bone = test::small_hip_bone();
  model.femur = test::small_femur();
  model.femoral_cartilage = test::surface_of(test::small_head_cartilage());
  model.head_radius = test::kHeadRadius;
  model.X_IP.R = model.X_IF.R = motion::supine_axes();
  if (side == Side::left) {
    for (TriMesh* mesh : {&model.hip_bone, &model.femur, &model.femoral_cartilage}) {
      mesh->points.col(0) *= -1.0;
      mesh->triangles.col(1).swap(mesh->triangles.col(2));
    }
  }
  return model;
}

/// From the top of the socket to the neck's axis when the neck meets the socket's inner rim, rad.
const double kNeckAtRim = test::kSocketAngle + std::asin(test::kNeckRadius / test::kSocketRadius);

/// From the top of the socket to the neck's axis in a pose.
double neck_from_top(const motion::HipAngles& pose, Side side) {
  const double lateral = side == Side::right ? 1.0 : -1.0;
  const Vec3 neck_F(0.0, -std::sin(test::kNeckTilt), lateral * std::cos(test::kNeckTilt));
  return std::acos((motion::rotation_from_angles(pose, side) * neck_F).y());
}

RomResult result_of(const RomModel& model, const RomTest& test, const RomOptions& options = {}) {
  return range_of_motion(model, {test}, options).front();
}
const RomTest kFlexion = {"flexion", {}, {radians(120.0), 0.0, 0.0}};

}  // namespace

TEST(RangeOfMotion, FlexionEndsWhereTheNeckMeetsTheRim) {
  for (const Side side : {Side::right, Side::left}) {
    const RomResult result = result_of(small_model(side), kFlexion);
    EXPECT_TRUE(result.contact);
    EXPECT_FALSE(result.blocked);
    EXPECT_NEAR(degrees(neck_from_top(result.pose, side)), degrees(kNeckAtRim), 1.0);
    EXPECT_DOUBLE_EQ(result.angle, result.pose.flexion);
    // on the inner rim, towards the front
    EXPECT_NEAR(result.place.norm(), test::kSocketRadius, 0.5);
    EXPECT_LT(result.place.y(), -10.0);
  }
}
TEST(RangeOfMotion, RotationAfterFlexionEndsAtTheSameRim) {
  for (const Side side : {Side::right, Side::left}) {
    const motion::HipAngles from{radians(70.0), 0.0, 0.0};
    const RomResult result =
        result_of(small_model(side), {"turn", from, {from.flexion, radians(40.0), 0.0}});
    const RomResult other =
        result_of(small_model(side), {"turn", from, {from.flexion, radians(-40.0), 0.0}});
    // abduction lifts the neck to the rim, adduction takes it away
    EXPECT_FALSE(result.contact);
    EXPECT_DOUBLE_EQ(result.angle, radians(40.0));
    EXPECT_TRUE(other.contact);
    EXPECT_NEAR(degrees(neck_from_top(other.pose, side)), degrees(kNeckAtRim), 1.0);
    EXPECT_DOUBLE_EQ(other.angle, -other.pose.adduction);
  }
}
TEST(RangeOfMotion, AContactOnTheWayToTheStartIsToldApart) {
  const RomResult result = result_of(
      small_model(), {"beyond", {radians(110.0), 0.0, 0.0}, {radians(110.0), 0.0, radians(30.0)}});
  EXPECT_TRUE(result.blocked);
  EXPECT_FALSE(result.contact);
  EXPECT_EQ(result.angle, 0.0);
  EXPECT_NEAR(degrees(neck_from_top(result.pose, Side::right)), degrees(kNeckAtRim), 1.0);
}
TEST(RangeOfMotion, AWiderThresholdEndsItEarlierAndTheStepChangesLittle) {
  const double exact = result_of(small_model(), kFlexion).angle;
  EXPECT_LT(result_of(small_model(), kFlexion, {.threshold = 1.0}).angle, exact - radians(1.0));
  EXPECT_NEAR(result_of(small_model(), kFlexion, {.step = radians(3.0)}).angle, exact,
              radians(0.1));
}
TEST(RangeOfMotion, CountsNeitherCoveredBoneNorTheFovea) {
  const RomModel model = small_model();
  const std::vector<bool> counted = counted_vertices(model);
  for (Index v = 0; v < model.femur.n_vertices(); ++v) {
    const Vec3 p = model.femur.points.row(v);
    const double from_top = std::acos(p.normalized().z());
    const bool covered = from_top < radians(70.0) && p.norm()<23.5, neck = p.norm()> 30.0;
    if (covered || neck) {
      EXPECT_EQ(counted[static_cast<std::size_t>(v)], neck) << p.transpose();
    }
  }
}
TEST(RangeOfMotion, HasTheFourExaminations) {
  std::vector<std::string> names;
  for (const RomTest& test : standard_rom_tests()) names.push_back(test.name);
  EXPECT_EQ(names, (std::vector<std::string>{"flexion", "internal_rotation_at_90_flexion", "fadir",
                                             "faber"}));
}
TEST(RangeOfMotion, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] {
    const RomResult result = result_of(small_model(), kFlexion);
    return std::vector<double>{result.angle, result.place.x(), result.place.y(), result.place.z()};
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(RangeOfMotion, RefusesMissingBonesAndSteps) {
  RomModel model = small_model();
  EXPECT_THROW(result_of(model, kFlexion, {.step = 0.0}), Error);
  model.hip_bone = {};
  EXPECT_THROW(result_of(model, kFlexion), Error);
}

}  // namespace coxa::measure
