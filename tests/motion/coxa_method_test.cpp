#include <coxa/motion/track.h>
#include <gtest/gtest.h>

#include "motion/synthetic_hip.h"

namespace coxa::motion {
namespace {

// thigh markers of `hip` carried by a shift that grows with the joint's angles, the same for all of
// them
void add_common_shift(test::SyntheticHip& hip, double size) {
  for (Index f = 0; f < hip.markers.n_frames(); ++f) {
    const HipAngles& a = hip.angles[static_cast<std::size_t>(f)];
    for (std::size_t m = 4; m < hip.markers.trajectories.size(); ++m) {
      hip.markers.trajectories[m].row(f) +=
          size * Eigen::RowVector3d(a.flexion, a.adduction, -a.flexion);
    }
  }
}
Vec3 error_of(const test::SyntheticHip& hip, PoseMethod method) {
  return test::rms_error(track(hip.markers, hip.model, {.method = method}), hip.angles);
}

}  // namespace

TEST(CoxaMethod, IsLessMisledByACommonShiftThanThePlainBallJoint) {
  auto hip = test::make_hip(200, 1.0);
  add_common_shift(hip, 15.0);
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(),
            0.7 * error_of(hip, PoseMethod::ball_joint).norm());
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(),
            0.7 * error_of(hip, PoseMethod::ball_joint_ml).norm());
}
TEST(CoxaMethod, WeighsMarkersWhereNoneShiftTogether) {
  auto hip = test::make_hip(300, 0.5);
  Rng rng(3);
  for (std::size_t m = 4; m < 9; ++m) {
    for (Index f = 0; f < 300; ++f)
      hip.markers.trajectories[m].row(f) += 15.0 * rng.normal3().transpose();
  }
  EXPECT_LE((error_of(hip, PoseMethod::coxa) - error_of(hip, PoseMethod::ball_joint_ml)).norm(),
            1e-9);
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(), 0.5 * error_of(hip, PoseMethod::rigid).norm());
}
TEST(CoxaMethod, SaysSoWhereFewFramesAreComplete) {
  auto hip = test::make_hip(40, 1.0);
  hip.markers.trajectories.back().topRows(35).setConstant(kNaN);
  const auto motion = track(hip.markers, hip.model, {.method = PoseMethod::coxa});
  ASSERT_FALSE(motion.warnings.empty());
  EXPECT_NE(motion.warnings.front().find("fewer than 10 frames show all thigh markers"),
            std::string::npos);
}
TEST(CoxaMethod, WidensTheIntervalOfBridgedFrames) {
  auto hip = test::make_hip(100, 1.0);
  const auto whole = track(hip.markers, hip.model);
  for (Points& trajectory : hip.markers.trajectories)
    trajectory.middleRows(40, 10).setConstant(kNaN);
  const auto bridged = track(hip.markers, hip.model);
  EXPECT_GT(bridged.interval[45].flexion, 1.5 * whole.interval[45].flexion);
  EXPECT_LT(bridged.interval[60].flexion, 1.2 * whole.interval[60].flexion);
}

}  // namespace coxa::motion
