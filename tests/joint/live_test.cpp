#include <coxa/joint/live.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "joint/layers.h"

namespace coxa::joint {
namespace {

JointModel small_hip() {
  return test::make_ball_in_cup({.cup_rings = 5, .head_rings = 7, .layers = 1});
}
const motion::HipAngles kFlexed{radians(4.6), 0.0, 0.0};

TEST(LiveHip, ReachesAPoseStepByStep) {
  const JointModel model = small_hip();
  LiveHip hip(model, passive_examination(model, 500.0));
  const int n_steps =
      static_cast<int>(std::ceil(kFlexed.flexion / live_options().max_rotation_step));
  LiveHip::Step step;
  for (int k = 0; k < n_steps; ++k) {
    step = hip.step_towards(kFlexed);
    EXPECT_EQ(step.frame.status, FrameStatus::converged);
    EXPECT_EQ(step.arrived, k + 1 == n_steps);
    if (k == 0) {
      EXPECT_NEAR(step.frame.angles.flexion, live_options().max_rotation_step, 1e-8);
    }
  }
  EXPECT_NEAR(degrees(hip.angles().flexion), 4.6, 1e-6);
}

TEST(LiveHip, SettledAgreesWithTheFullSolution) {
  const JointModel model = small_hip();
  const LoadCase load = passive_examination(model, 500.0);
  LiveHip hip(model, load);
  while (!hip.step_towards(kFlexed).arrived) {
  }
  const FrameResult settled = hip.settle().frame;
  motion::HipMotion motion;
  for (const motion::HipAngles& angles : {motion::HipAngles{}, kFlexed}) {
    motion.time.push_back(angles.flexion);
    motion.angles.push_back(angles);
    motion.X_PF.push_back({motion::rotation_from_angles(angles, Side::right), Vec3::Zero()});
  }
  const JointResult full = simulate(model, motion, load, {.centre_shift = std::nullopt});
  ASSERT_EQ(full.frames[1].status, FrameStatus::converged);
  ASSERT_EQ(settled.status, FrameStatus::converged);
  // a ball that turns in its cup: both ways end in the same equilibrium, to the tolerance
  EXPECT_NEAR(settled.contact.peak_pressure_p99, full.frames[1].contact.peak_pressure_p99,
              0.03 * full.frames[1].contact.peak_pressure_p99);
  EXPECT_NEAR(settled.contact.contact_area, full.frames[1].contact.contact_area,
              0.03 * full.frames[1].contact.contact_area);
}

TEST(LiveHip, TakesShorterStepsWhereALongOneFindsNoEquilibrium) {
  // facets of 13 mm: beyond 59 degrees steps of 1 degree find no equilibrium, shorter ones do
  const JointModel model = test::make_ball_in_cup({.cup_rings = 2, .head_rings = 3, .layers = 1});
  LiveHip hip(model, passive_examination(model, 200.0));
  double shortest = kInfinity;
  for (int k = 0; k < 80; ++k) {
    const double before = hip.angles().flexion;
    const LiveHip::Step step = hip.step_towards({radians(65.0), 0.0, 0.0});
    if (step.frame.status != FrameStatus::converged || step.arrived) break;
    shortest = std::min(shortest, hip.angles().flexion - before);
  }
  EXPECT_GT(degrees(hip.angles().flexion), 59.2);
  EXPECT_LT(shortest, 0.6 * live_options().max_rotation_step);
}

TEST(LiveHip, StaysNearTheSettledStateAllAlong) {
  const JointModel model = test::make_ball_in_cup({.cup_rings = 8, .head_rings = 11, .layers = 1});
  LiveHip hip(model, passive_examination(model, 500.0));
  LiveHip::Step step;
  do {
    step = hip.step_towards({radians(9.0), 0.0, radians(4.0)});
  } while (!step.arrived);
  const FrameResult settled = hip.settle().frame;
  ASSERT_EQ(settled.status, FrameStatus::converged);
  EXPECT_NEAR(step.frame.contact.mean_pressure, settled.contact.mean_pressure,
              0.05 * settled.contact.mean_pressure);
  EXPECT_NEAR(step.frame.contact.contact_area, settled.contact.contact_area,
              0.05 * settled.contact.contact_area);
  EXPECT_LT(step.frame.balance.force_error, 0.03);
}

TEST(LiveHip, RefusesALoadThatChangesFromFrameToFrame) {
  const JointModel model = small_hip();
  LoadCase load = passive_examination(model, 500.0);
  load.force_P.conservativeResize(2, 3);
  load.force_P.row(1) = load.force_P.row(0);
  EXPECT_THROW(LiveHip(model, load), Error);
}

}  // namespace
}  // namespace coxa::joint
