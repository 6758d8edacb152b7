#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/joint/live.h>
#include <coxa/joint/simulate.h>
#include <gtest/gtest.h>

#include <cmath>

#include "joint/layers.h"
#include "joint/movements.h"

namespace coxa::joint {
namespace {

const JointOptions quick = {.centre_shift = std::nullopt};

JointModel turned_ball(double friction) {
  test::BallInCup shape;
  shape.cup_rings = 8;
  shape.head_rings = 11;
  shape.layers = 1;
  JointModel model = test::make_ball_in_cup(shape);
  model.friction = friction;
  return model;
}
/// A ball in a cup of a radius 2 mm larger, stiff so that it slides rather than shears.
JointModel loose_ball(double friction) {
  test::BallInCup shape;
  shape.gap = 2.0;
  shape.cup_rings = 14;
  shape.head_rings = 19;
  shape.layers = 1;
  JointModel model = test::make_ball_in_cup(shape);
  model.material.youngs_modulus = 200.0;
  model.friction = friction;
  return model;
}
/// 60 N straight into the cup, then 60 N that lean forwards.
LoadCase leaning(double angle) {
  LoadCase load;
  load.mode = LoadMode::force;
  load.force_P.resize(2, 3);
  load.force_P << 0.0, 60.0, 0.0, 60.0 * std::sin(angle), 60.0 * std::cos(angle), 0.0;
  return load;
}
/// How far forwards the second force moves the ball, mm.
double way_forwards(double friction, double angle) {
  const JointModel model = loose_ball(friction);
  const JointResult result = simulate(model, test::movement_to({}, 2), leaning(angle), quick);
  EXPECT_EQ(result.n_converged(), 2) << result.frames[1].reason;
  EXPECT_LT(result.frames[1].balance.force_error, 1e-3);
  EXPECT_LT(result.frames[1].balance.reaction_error, 2e-3);
  return result.frames[0].translation.y() - result.frames[1].translation.y();
}

}  // namespace

TEST(Friction, OfATurningBallIsTheMomentOfTheClosedForm) {
  // pressure p0 cos(theta) on a cap: mu F R sin^3 th / (1 - cos^3 th) about its axis
  const double mu = 0.05, force = 500.0, radius = 25.0;
  JointModel model = test::make_ball_in_cup();
  model.friction = mu;
  const auto motion = test::movement_to({0.0, 0.0, radians(12.0)}, 3);
  const JointResult result = simulate(model, motion, passive_examination(model, force), quick);
  ASSERT_EQ(result.n_converged(), 3);
  const double sine = std::sin(radians(60.0)),
               wanted = mu * force * radius * sine * sine * sine / (1.0 - 0.125);
  EXPECT_LT(result.frames[0].balance.friction_moment.norm(), 0.05 * wanted);
  for (int k = 1; k < 3; ++k) {
    const BalanceFigures& balance = result.frames[static_cast<std::size_t>(k)].balance;
    EXPECT_NEAR(std::abs(balance.friction_moment.z()), wanted, 0.02 * wanted);
    EXPECT_LT(balance.force_error, 1e-3);
    EXPECT_LT(balance.reaction_error, 1e-3);
  }
}
TEST(Friction, TurnsRoundWithTheMovementAndIsLessBeforeItSlides) {
  const JointModel model = turned_ball(0.05);
  // there, a little way back, and all the way back
  auto motion = test::movement_to({0.0, 0.0, radians(6.0)}, 2);
  for (const double angle : {5.95, 0.0}) {
    const motion::HipAngles angles{0.0, 0.0, radians(angle)};
    motion.time.push_back(motion.time.back() + 1.0);
    motion.angles.push_back(angles);
    motion.X_PF.push_back({motion::rotation_from_angles(angles, model.side), Vec3::Zero()});
  }
  const JointResult result = simulate(model, motion, passive_examination(model, 500.0), quick);
  ASSERT_EQ(result.n_converged(), 4);
  const auto moment = [&](std::size_t k) { return result.frames[k].balance.friction_moment.z(); };
  EXPECT_NEAR(moment(3), -moment(1), 0.02 * std::abs(moment(1)));
  EXPECT_LT(std::abs(moment(2)), 0.9 * std::abs(moment(1)));
}
TEST(Friction, HoldsAgainstALoadWithinItsConeAndLetsTheRestSlide) {
  const double angle = std::atan(0.4);
  // without friction the ball goes where the cup's normal is the force's
  EXPECT_NEAR(way_forwards(0.0, angle), 2.0 * std::sin(angle), 0.05);
  // with it, where the force is at the border of the cone about the normal
  EXPECT_NEAR(way_forwards(0.3, angle), 2.0 * std::sin(angle - std::atan(0.3)), 0.05);
  EXPECT_LT(way_forwards(0.5, angle), 0.05);
}
TEST(Friction, OfNothingLeavesTheResultAsItIs) {
  const auto motion = test::movement_to({radians(5.0), 0.0, 0.0}, 2);
  const JointModel smooth = turned_ball(0.0), hardly = turned_ball(1e-9);
  const auto load = passive_examination(smooth, 500.0);
  const JointResult a = simulate(smooth, motion, load, quick);
  const JointResult b = simulate(hardly, motion, load, quick);
  ASSERT_EQ(b.n_converged(), 2);
  EXPECT_NEAR(a.frames[1].contact.peak_pressure_p99, b.frames[1].contact.peak_pressure_p99, 1e-3);
}
TEST(Friction, IsTheSameForOneAndEightThreadsAndWhenLedByHand) {
  const JointModel model = turned_ball(0.05);
  const auto motion = test::movement_to({0.0, 0.0, radians(4.0)}, 2);
  const auto load = passive_examination(model, 500.0);
  const auto run = [&] { return simulate(model, motion, load, quick).frames[1]; };
  const FrameResult one = with_threads(1, run), eight = with_threads(8, run);
  EXPECT_EQ(one.balance.friction_moment, eight.balance.friction_moment);
  EXPECT_EQ(one.acetabular_displacement, eight.acetabular_displacement);
  LiveHip hip(model, load);
  LiveHip::Step step;
  do step = hip.step_towards({0.0, 0.0, radians(4.0)});
  while (!step.arrived);
  ASSERT_EQ(step.frame.status, FrameStatus::converged) << step.frame.reason;
  EXPECT_NEAR(step.frame.balance.friction_moment.z(), one.balance.friction_moment.z(),
              0.05 * one.balance.friction_moment.norm());
}
TEST(Friction, BelowZeroIsRejected) {
  const JointModel model = turned_ball(-0.1);
  EXPECT_THROW(simulate(model, test::movement_to({}, 1), passive_examination(model, 500.0), quick),
               Error);
}

}  // namespace coxa::joint
