#include <coxa/core/error.h>
#include <coxa/joint/live.h>
#include <coxa/joint/simulate.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "../../src/joint/bone_limit.h"
#include "../../src/joint/led_limit.h"
#include "joint/layers.h"
#include "joint/movements.h"
#include "support/shapes.h"

namespace coxa::joint {
namespace {

constexpr double kReach = 40.0, kBall = 3.0;  // mm
constexpr double kStopAt = radians(40.0);     // flexion that would lay one ball on the other
const double kTouch = 2.0 * std::asin(kBall / kReach);  // angle between balls that just touch

/// A ball on the femur, 40 mm below the joint centre, and one on the hip bone where 40 degrees of
/// flexion bring it.
JointModel with_bones() {
  JointModel model = test::make_ball_in_cup({.cup_rings = 5, .head_rings = 7, .layers = 1});
  const auto at = [](double flexion) {  // anterior is -y
    return Vec3(0.0, -kReach * std::sin(flexion), -kReach * std::cos(flexion));
  };
  model.femur = test::icosphere(3, kBall, at(0.0));
  model.hip_bone = test::icosphere(3, kBall, at(kStopAt));
  return model;
}

TEST(BonyLimit, IsFoundWhereTheBonesFirstTouch) {
  const JointModel model = with_bones();
  const auto motion = test::movement_to({radians(50.0), 0.0, 0.0}, 11);
  const JointResult result =
      simulate(model, motion, passive_examination(model, 200.0), {.centre_shift = std::nullopt});
  ASSERT_TRUE(result.bony_limit.has_value());
  const double expected = kStopAt - kTouch;  // 31.4 degrees
  // facets lie up to 0.02 mm inside the balls; the head moves some hundredths of a millimetre
  EXPECT_NEAR(degrees(result.bony_limit->angles.flexion), degrees(expected), 0.2);
  EXPECT_EQ(result.bony_limit->frame, 7);
  for (const FrameResult& frame : result.frames) {
    const bool beyond = frame.angles.flexion > expected && frame.angles.flexion < kStopAt + kTouch;
    EXPECT_EQ(frame.status == FrameStatus::beyond_bony_limit, beyond) << frame.frame;
    const bool says_so = frame.reason.find("the bones would overlap by") != std::string::npos;
    EXPECT_EQ(says_so, beyond);
    EXPECT_EQ(frame.acetabular_pressure.size() == 0, beyond);
  }
  // on the hip bone's ball, towards the femur's
  const Vec3 from(0.0, -kReach * std::sin(expected), -kReach * std::cos(expected));
  const Vec3 to(0.0, -kReach * std::sin(kStopAt), -kReach * std::cos(kStopAt));
  EXPECT_LT((result.bony_limit->place - 0.5 * (from + to)).norm(), 0.5);
}

TEST(BonyLimit, ClearanceIsTheDistanceOfTheBones) {
  const JointModel model = with_bones();
  const auto motion = test::movement_to({radians(29.0), 0.0, 0.0}, 2);
  const JointResult result =
      simulate(model, motion, passive_examination(model, 200.0), {.centre_shift = std::nullopt});
  EXPECT_FALSE(result.bony_limit.has_value());
  EXPECT_TRUE(std::isnan(result.frames[0].bone_clearance));  // not near
  const double apart = 2.0 * kReach * std::sin(0.5 * radians(11.0)) - 2.0 * kBall;
  EXPECT_NEAR(result.frames[1].bone_clearance, apart, 0.06);
}

TEST(BonyLimit, IsWatchedByALedHipAsByASimulation) {
  const JointModel model = with_bones();
  LedLimit led(model, model.hip_bone);
  const BoneLimit limit(model);
  int n_near = 0;
  for (int k = 0; k <= 40; ++k) {
    const Mat3 R = Eigen::AngleAxisd(-radians(k), Vec3::UnitX()).matrix();
    const RigidTransform X_II{R, Vec3(0.01 * k, 0.0, 0.0)};
    const auto found = led.nearest(X_II);
    const double all_around = limit.clearance(X_II);
    if (!found) {
      EXPECT_FALSE(all_around < 3.0) << k;
      continue;
    }
    EXPECT_EQ(found->distance, all_around) << k;
    ++n_near;
  }
  EXPECT_GT(n_near, 9);
}

TEST(LabrumContact, IsToldWhileAHandLeads) {
  // a ball in the way of the femur's at 20 degrees, another, of bone, at 40
  JointModel model = with_bones();
  const double at = radians(20.0);
  const Vec3 place(0.0, -kReach * std::sin(at), -kReach * std::cos(at));
  model.labrum = test::icosphere(3, kBall, place);
  LiveHip hip(model, passive_examination(model, 200.0));
  bool touched = false;
  for (int k = 0; k < 60; ++k) {
    const LiveHip::Step step = hip.step_towards({radians(50.0), 0.0, 0.0});
    if (step.labrum) {
      EXPECT_EQ(step.labrum->clearance, step.frame.labrum_clearance);
      EXPECT_NEAR((step.labrum->point - place).norm(), kBall, 0.05);
      touched = touched || step.labrum->clearance < 0.0;
    }
    if (step.frame.status == FrameStatus::beyond_bony_limit) {
      // the labrum let it pass, the bone does not
      EXPECT_TRUE(touched);
      ASSERT_TRUE(step.bone.has_value());
      EXPECT_LT(step.bone->clearance, 0.0);
      EXPECT_NEAR(step.bone->hour, socket_clock(model).hour(step.bone->point), 1e-12);
      EXPECT_NEAR(degrees(hip.angles().flexion), degrees(kStopAt - kTouch), 1.1);
      return;
    }
    ASSERT_EQ(step.frame.status, FrameStatus::converged) << step.frame.reason;
  }
  FAIL() << "the bones never met";
}

TEST(BonyLimit, VerticesUnderTheCartilageDoNotCount) {
  JointModel model = with_bones();
  // a femur that is the head's bone itself: it lies under the cartilage and never counts
  model.femur = test::icosphere(3, 23.0, Vec3::Zero());
  model.hip_bone = test::icosphere(2, kBall, Vec3(0.0, 0.0, 24.0));
  const JointResult result =
      simulate(model, test::movement_to({}, 1), passive_examination(model, 200.0),
               {.centre_shift = std::nullopt});
  EXPECT_NE(result.frames[0].status, FrameStatus::beyond_bony_limit);
}

TEST(LabrumContact, IsFoundWhereTheFemurFirstTouchesItAndStopsNothing) {
  // a second ball, where 20 degrees of flexion would lay the femur's on it
  JointModel model = with_bones();
  const double at = radians(20.0), expected = at - kTouch;
  model.labrum =
      test::icosphere(3, kBall, Vec3(0.0, -kReach * std::sin(at), -kReach * std::cos(at)));
  const auto motion = test::movement_to({radians(24.0), 0.0, 0.0}, 9);
  const LoadCase load = passive_examination(model, 200.0);
  const JointResult result = simulate(model, motion, load, {.centre_shift = std::nullopt});
  EXPECT_TRUE(result.has_labrum);
  ASSERT_TRUE(result.labrum_contact.has_value());
  EXPECT_EQ(result.labrum_contact->frame, 4);  // 12 degrees; 9 are before
  EXPECT_NEAR(degrees(result.labrum_contact->angles.flexion), degrees(expected), 0.2);
  EXPECT_FALSE(result.bony_limit.has_value());
  EXPECT_GT(result.frames[3].labrum_clearance, 0.0);
  EXPECT_LT(result.frames[4].labrum_clearance, 0.0);

  model.labrum = {};
  const JointResult without = simulate(model, motion, load, {.centre_shift = std::nullopt});
  EXPECT_FALSE(without.labrum_contact.has_value());
  EXPECT_TRUE(std::isnan(without.frames[4].labrum_clearance));
  for (std::size_t k = 0; k < result.frames.size(); ++k) {
    ASSERT_EQ(result.frames[k].status, FrameStatus::converged) << result.frames[k].reason;
    EXPECT_EQ(result.frames[k].acetabular_pressure, without.frames[k].acetabular_pressure);
  }
}
TEST(LabrumContact, NeedsAClosedSurfaceAndBones) {
  const auto fault = [](const JointModel& model) -> std::string {
    try {
      check_model(model);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  JointModel model = with_bones();
  model.labrum = test::cap_directions(1.0, 3);
  EXPECT_NE(fault(model).find("labrum"), std::string::npos) << fault(model);
  model.labrum = test::icosphere(2, kBall, Vec3::Zero());
  EXPECT_EQ(fault(model), "nothing");
  model.hip_bone = model.femur = {};
  EXPECT_NE(fault(model).find("with the labrum needs both bone surfaces"), std::string::npos);
}

TEST(BonyLimit, StopsAHipLedByHand) {
  const JointModel model = with_bones();
  LiveHip hip(model, passive_examination(model, 200.0));
  LiveHip::Step step;
  do {
    step = hip.step_towards({radians(45.0), 0.0, 0.0});
  } while (!step.arrived && step.frame.status == FrameStatus::converged);
  EXPECT_EQ(step.frame.status, FrameStatus::beyond_bony_limit) << step.frame.reason;
  EXPECT_LT(hip.angles().flexion, kStopAt - kTouch + radians(0.2));
  EXPECT_GT(hip.angles().flexion, kStopAt - kTouch - live_options().max_rotation_step);
}

}  // namespace
}  // namespace coxa::joint
