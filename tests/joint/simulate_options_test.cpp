#include <coxa/joint/simulate.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <string>

#include "joint/layers.h"
#include "joint/movements.h"

namespace coxa::joint {
namespace {

test::BallInCup small_shape() {
  test::BallInCup shape;
  shape.cup_rings = 6;
  shape.head_rings = 8;
  shape.layers = 1;
  return shape;
}
const JointModel model = test::make_ball_in_cup(small_shape());
const LoadCase load = passive_examination(model, 500.0);

JointResult run(JointOptions options, const motion::HipMotion& motion = test::movement_to({}, 1)) {
  options.centre_shift.reset();
  return simulate(model, motion, load, options);
}

}  // namespace

TEST(JointOptions, MultipliersBringPenetrationBelowItsTolerance) {
  const double loose = run({.penetration_tolerance = 1.0}).frames[0].contact.penetration;
  EXPECT_GT(loose, 0.4 / 100.0);  // pressure over stiffness: pure penalty
  const double tight = run({.penetration_tolerance = 5e-4}).frames[0].contact.penetration;
  EXPECT_LE(tight, 5e-4);
}
TEST(JointOptions, StifferPenaltyLeavesLessPenetration) {
  const JointOptions soft{.contact_stiffness = 50.0, .penetration_tolerance = 1.0};
  const JointOptions hard{.contact_stiffness = 500.0, .penetration_tolerance = 1.0};
  // ten times at equal pressure; the softer one evens the pressure out
  const double ratio =
      run(soft).frames[0].contact.penetration / run(hard).frames[0].contact.penetration;
  EXPECT_GT(ratio, 5.0);
  EXPECT_LT(ratio, 10.0);
}
TEST(JointOptions, ResidualToleranceIsKept) {
  EXPECT_LE(run({.residual_tolerance = 1e-7}).frames[0].residual, 1e-7);
}
TEST(JointOptions, SmallerSubStepsCostMoreIterationsForTheSameResult) {
  const auto motion = test::movement_to({radians(4.0), 0.0, 0.0}, 2);
  const JointResult one = run({.max_rotation_step = radians(5.0)}, motion);
  const JointResult many = run({.max_rotation_step = radians(0.5)}, motion);
  EXPECT_GT(many.frames[1].iterations, one.frames[1].iterations);
  EXPECT_NEAR(many.frames[1].contact.peak_pressure_p99, one.frames[1].contact.peak_pressure_p99,
              0.02);
}
TEST(JointOptions, TranslationStepCutsAPrescribedWay) {
  auto motion = test::movement_to({}, 2);
  motion.X_PF[1].p = Vec3(0, 0.2, 0);
  const auto iterations = [&](double step) {
    return simulate(model, motion, prescribed_pose(),
                    {.max_translation_step = step, .centre_shift = std::nullopt})
        .frames[1]
        .iterations;
  };
  EXPECT_GT(iterations(0.02), iterations(0.5));
}
TEST(JointOptions, TooFewIterationsFailWithTheFigures) {
  for (const JointOptions& options :
       {JointOptions{.max_newton_iterations = 1, .max_contact_updates = 1, .max_cutbacks = 0},
        JointOptions{.max_contact_updates = 1, .max_cutbacks = 0}}) {
    const FrameResult frame = run(options).frames[0];
    ASSERT_EQ(frame.status, FrameStatus::failed);
    EXPECT_NE(frame.reason.find("no equilibrium after"), std::string::npos) << frame.reason;
    EXPECT_NE(frame.reason.find("limit"), std::string::npos);
  }
}
TEST(JointOptions, CutbacksAreTriedBeforeAFrameFails) {
  const auto motion = test::movement_to({radians(3.0), 0.0, 0.0}, 2);
  const auto iterations = [&](int cutbacks) {
    return run({.max_contact_updates = 1, .max_cutbacks = cutbacks}, motion).frames[1].iterations;
  };
  EXPECT_GT(iterations(3), iterations(0));
}
TEST(JointOptions, HeadMayNotMoveFartherThanMaxTranslation) {
  const FrameResult frame = run({.max_translation = 0.01}).frames[0];
  ASSERT_EQ(frame.status, FrameStatus::failed);
  EXPECT_NE(frame.reason.find("limit 0.01 mm"), std::string::npos) << frame.reason;
}
TEST(JointOptions, ArePositive) {
  for (const JointOptions& options :
       {JointOptions{.contact_stiffness = 0.0}, JointOptions{.penetration_tolerance = -1.0},
        JointOptions{.residual_tolerance = 0.0}, JointOptions{.max_rotation_step = 0.0},
        JointOptions{.max_translation_step = 0.0}, JointOptions{.max_newton_iterations = 0},
        JointOptions{.max_contact_updates = 0}, JointOptions{.max_cutbacks = -1},
        JointOptions{.max_translation = 0.0}}) {
    EXPECT_THROW(run(options), Error);
  }
  EXPECT_THROW(simulate(model, test::movement_to({}, 1), load, {.centre_shift = 0.0}), Error);
}
TEST(SimulateInput, MovementAndLoadMustFit) {
  motion::HipMotion motion = test::movement_to({}, 3);
  motion.X_PF.pop_back();
  EXPECT_THROW(simulate(model, motion, load), Error);
  EXPECT_THROW(simulate(model, motion::HipMotion{}, load), Error);
  LoadCase wrong = load;
  wrong.force_P = Points::Ones(2, 3);
  EXPECT_THROW(simulate(model, test::movement_to({}, 3), wrong), Error);
  wrong.force_P = Points::Zero(1, 3);
  EXPECT_THROW(simulate(model, test::movement_to({}, 3), wrong), Error);
}

}  // namespace coxa::joint
