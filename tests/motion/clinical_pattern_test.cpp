#include <coxa/motion/clinical_pattern.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

namespace coxa::motion {
namespace {

const ClinicalPattern kFlexion = simple_pattern("flexion", {}, {.flexion = radians(90)}, 2.0);
ClinicalPattern wave() {
  ClinicalPattern pattern{.name = "wave", .interpolation = Interpolation::periodic};
  for (int k = 0; k <= 12; ++k)
    pattern.poses.push_back({k / 12.0, {.flexion = 0.5 * std::sin(2 * kPi * k / 12.0)}});
  return pattern;
}

}  // namespace

TEST(ClinicalPattern, BeginsAndEndsInItsPoses) {
  const HipMotion motion = make_movement(kFlexion, Side::left, {.rate = 10});
  ASSERT_EQ(motion.n_frames(), 21);
  EXPECT_EQ(motion.time.back(), 2.0);
  EXPECT_EQ(motion.angles.front().flexion, 0.0);
  EXPECT_NEAR(motion.angles.back().flexion, radians(90), 1e-12);
  EXPECT_NEAR(motion.angles[10].flexion, radians(45), 1e-12);
  EXPECT_LE((motion.X_PF[10].R - rotation_from_angles(motion.angles[10], Side::left)).norm(),
            1e-12);
}
TEST(ClinicalPattern, GivesTheFramesAskedFor) {
  EXPECT_EQ(make_movement(kFlexion, Side::right, {.n_frames = 7}).n_frames(), 7);
  EXPECT_EQ(make_movement(wave(), Side::right, {.rate = 20, .cycles = 3}).n_frames(), 61);
  EXPECT_THROW(make_movement(kFlexion, Side::right, {.cycles = 2}), Error);
  EXPECT_THROW(make_movement(kFlexion, Side::right, {.rate = 0}), Error);
}
TEST(ClinicalPattern, PeriodicCurvesFollowASineClosely) {
  const ClinicalPattern pattern = wave();
  for (double t = 0.0; t <= 1.0; t += 0.01)
    EXPECT_NEAR(angles_at(pattern, t).flexion, 0.5 * std::sin(2 * kPi * t), 1e-3);
}
TEST(ClinicalPattern, PeriodicCurvesMustClose) {
  ClinicalPattern open = wave();
  open.poses.back().angles.flexion = 0.3;
  EXPECT_THROW(angles_at(open, 0.0), Error);
}
TEST(ClinicalPattern, LinearIsStraight) {
  ClinicalPattern pattern = kFlexion;
  pattern.interpolation = Interpolation::linear;
  EXPECT_NEAR(angles_at(pattern, 0.5).flexion, radians(22.5), 1e-12);
}
TEST(ClinicalPattern, BlendsFromOneIntoTheOther) {
  const auto back = simple_pattern("back", {.flexion = radians(80)}, {}, 2.0);
  const auto both = blended(kFlexion, back, 0.5);
  EXPECT_NEAR(both.poses.back().time, 3.5, 1e-12);
  EXPECT_NEAR(both.poses.back().angles.flexion, 0.0, 1e-12);
  double largest = 0.0;
  for (std::size_t k = 1; k < both.poses.size(); ++k) {
    largest = std::max(largest,
                       std::abs(both.poses[k].angles.flexion - both.poses[k - 1].angles.flexion));
  }
  EXPECT_LT(largest, radians(2.0));
  EXPECT_THROW(blended(kFlexion, back, 0.0), Error);
  EXPECT_THROW(blended(kFlexion, back, 5.0), Error);
}
TEST(ClinicalPattern, NamesWhatIsWrongWithItsTimes) {
  ClinicalPattern pattern = kFlexion;
  pattern.poses[1].time = 0.0;
  try {
    make_movement(pattern, Side::right);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "the times of the movement 'flexion' must increase, pose 2 does not");
  }
}

}  // namespace coxa::motion
