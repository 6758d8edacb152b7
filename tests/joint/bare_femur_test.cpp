#include <coxa/joint/simulate.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "joint/layers.h"
#include "joint/movements.h"
#include "support/shapes.h"

namespace coxa::joint {
namespace {

constexpr double kRadius = 25.0;  // mm, of the bare head and of the hollow in the cartilage

/// A bare round head in a socket of cartilage; the femoral cartilage is a small cap below, where
/// nothing touches it.
JointModel bare_head(const Vec3& head = Vec3::Zero()) {
  JointModel model = test::make_ball_in_cup({.cup_rings = 10, .layers = 2});
  const Mat3 below = Vec3(1, -1, -1).asDiagonal();
  model.femoral_cartilage = test::cap_shell(kRadius - 4.0, kRadius - 2.5, radians(20.0), 4, 1);
  model.femoral_cartilage.points *= below;
  model.femur = test::icosphere(5, kRadius, head);
  model.hip_bone = test::icosphere(2, 5.0, Vec3(0, 0, 200));
  model.bare_bone = BareBone::both;
  return model;
}
FrameResult last_of(const JointModel& model, double force, double flexion = 0.0) {
  const auto motion = test::movement_to({flexion, 0.0, 0.0}, flexion == 0.0 ? 1 : 2);
  return simulate(model, motion, passive_examination(model, force), {.centre_shift = std::nullopt})
      .frames.back();
}

TEST(BareFemur, BearsTheSocketsCartilageLikeAWinklerBed) {
  // one layer on a rigid ball: p0 = 3 F / (2 pi R^2 (1 - cos^3 th)), and it gives by p0 h / M
  const FrameResult frame = last_of(bare_head(), 2000.0);
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  const double p0 = 3.0 * 2000.0 / (2.0 * kPi * kRadius * kRadius * (1.0 - 0.125));
  EXPECT_NEAR(frame.acetabular_pressure.maxCoeff(), p0, 0.05 * p0);
  EXPECT_NEAR(frame.translation.z(), p0 * 1.5 / 30.63, 0.1 * frame.translation.z());
  EXPECT_NEAR(frame.balance.force_of_femur.z(), 2000.0, 1.0);
  EXPECT_EQ(frame.balance.force_on_bone.norm(), 0.0);
  EXPECT_EQ(frame.contact.contact_area, 0.0);  // of cartilage on cartilage
  EXPECT_LT(frame.balance.force_error, 1e-3);
  EXPECT_LT(frame.balance.reaction_error, 1e-3);
}
TEST(BareFemur, TurnsWithTheFemur) {
  // a ball 1 mm beside the centre it turns about comes to rest where it was: t = c - R c
  const Vec3 beside(0.0, 1.0, 0.0);
  const FrameResult before = last_of(bare_head(beside), 500.0);
  const FrameResult after = last_of(bare_head(beside), 500.0, radians(20.0));
  ASSERT_EQ(before.status, FrameStatus::converged) << before.reason;
  ASSERT_EQ(after.status, FrameStatus::converged) << after.reason;
  const Vec3 moved = after.translation - before.translation;
  EXPECT_GT(moved.norm(), 0.3);
  EXPECT_LT((moved - (beside - after.X_II.R * beside)).norm(), 0.02);
}
TEST(BareFemur, IsLookedForOnlyWhenAskedFor) {
  JointModel model = bare_head();
  model.bare_bone = BareBone::hip_bone;
  const FrameResult frame = last_of(model, 500.0);
  EXPECT_EQ(frame.status, FrameStatus::failed);  // nothing holds the head
}
TEST(BareFemur, HelpsAPadOnTheHead) {
  // a small pad of cartilage on the head, which the socket's cartilage would else close around
  JointModel model = test::make_ball_in_cup(
      {.head_angle = radians(18.0), .cup_rings = 12, .head_rings = 6, .layers = 1});
  model.femur = test::icosphere(5, kRadius - 0.2, Vec3::Zero());
  model.hip_bone = test::icosphere(2, 5.0, Vec3(0, 0, 200));
  const FrameResult without = last_of(model, 800.0);
  model.bare_bone = BareBone::both;
  const FrameResult with = last_of(model, 800.0);
  ASSERT_EQ(without.status, FrameStatus::converged) << without.reason;
  ASSERT_EQ(with.status, FrameStatus::converged) << with.reason;
  const double on_femur = with.balance.force_of_femur.z();
  EXPECT_GT(on_femur, 50.0);
  EXPECT_LT(on_femur, 750.0);
  EXPECT_NEAR(with.balance.contact_force.z(), 800.0, 1.0);
  EXPECT_NEAR(with.balance.socket_reaction.z(), 800.0, 2.0);
  EXPECT_NEAR(with.balance.femur_reaction.z(), -(800.0 - on_femur), 2.0);
  EXPECT_LT(with.contact.peak_pressure_p99, without.contact.peak_pressure_p99);
  EXPECT_LT(with.balance.reaction_error, 1e-3);
}
TEST(BareFemur, NeedsBones) {
  JointModel model = test::make_ball_in_cup({.cup_rings = 5, .head_rings = 7, .layers = 1});
  model.bare_bone = BareBone::both;
  try {
    check_model(model);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("needs both bone surfaces"), std::string::npos);
  }
}

}  // namespace
}  // namespace coxa::joint
