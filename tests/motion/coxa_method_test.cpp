#include <coxa/motion/track.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "motion/synthetic_hip.h"

namespace coxa::motion {
namespace {

constexpr std::size_t kFirstThigh = 4;  // columns of the synthetic hip's thigh markers

// thigh markers of `hip` carried by a shift that grows with the joint's angles, the same for all of
// them
void add_common_shift(test::SyntheticHip& hip, double size) {
  for (Index f = 0; f < hip.markers.n_frames(); ++f) {
    const HipAngles& a = hip.angles[static_cast<std::size_t>(f)];
    for (std::size_t m = kFirstThigh; m < hip.markers.trajectories.size(); ++m) {
      hip.markers.trajectories[m].row(f) +=
          size * Eigen::RowVector3d(a.flexion, a.adduction, -a.flexion);
    }
  }
}

// artefact in femur axes, independent from frame to frame: one size per marker, times one per axis
void add_artefact(test::SyntheticHip& hip, const VecX& marker_sd, const Vec3& axis,
                  std::uint64_t seed) {
  Rng rng(seed);
  const auto truth = track_in_detail(hip.markers, hip.model, {.method = PoseMethod::rigid});
  for (std::size_t f = 0; f < truth.X_LF.size(); ++f) {
    for (Index m = 0; m < marker_sd.size(); ++m) {
      const Vec3 e = marker_sd[m] * axis.cwiseProduct(rng.normal3());
      hip.markers.trajectories[kFirstThigh + static_cast<std::size_t>(m)].row(
          static_cast<Index>(f)) += truth.X_LF[f].R * e;
    }
  }
}

Vec3 error_of(const test::SyntheticHip& hip, PoseMethod method, const TrackOptions& others = {}) {
  TrackOptions options = others;
  options.method = method;
  return test::rms_error(track(hip.markers, hip.model, options), hip.angles);
}

// generalised least squares with the true covariance: nothing linear does better; rad
double best_possible(const test::SyntheticHip& hip, const VecX& marker_sd, const Vec3& axis) {
  Mat3 information = Mat3::Zero();
  Index m = 0;
  for (const auto& [label, site] : hip.model.thigh_markers) {
    const Vec3 x = site - hip.model.joint_centre_femur;
    Mat3 J;
    J << 0, x.z(), -x.y(), -x.z(), 0, x.x(), x.y(), -x.x(), 0;
    const Vec3 weight = (marker_sd[m++] * axis).cwiseAbs2().cwiseInverse();
    information += J.transpose() * weight.asDiagonal() * J;
  }
  return std::sqrt(information.inverse().trace());
}

}  // namespace

TEST(CoxaMethod, IsLessMisledByACommonShiftThanThePinnedBallJoints) {
  auto hip = test::make_hip(200, 1.0);
  add_common_shift(hip, 15.0);
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(),
            0.9 * error_of(hip, PoseMethod::ball_joint).norm());
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(),
            0.9 * error_of(hip, PoseMethod::ball_joint_ml).norm());
}
TEST(CoxaMethod, ComesNearTheBestThatKnownSizesOfArtefactAllow) {
  VecX sd(8);
  sd << 2, 12, 3, 10, 2, 9, 14, 4;
  const Vec3 axis(1.6, 1.0, 0.6);
  auto hip = test::make_hip(600);
  add_artefact(hip, sd, axis, 3);
  const double best = best_possible(hip, sd, axis);
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(), 1.3 * best);
  EXPECT_GT(error_of(hip, PoseMethod::ball_joint).norm(), 1.5 * best);
  EXPECT_GT(error_of(hip, PoseMethod::rigid).norm(), 1.5 * best);
}
TEST(CoxaMethod, IntervalsHoldTheTruthWhereTheArtefactDiffersFromMarkerToMarker) {
  VecX sd(8);
  sd << 2, 12, 3, 10, 2, 9, 14, 4;
  auto hip = test::make_hip(600);
  add_artefact(hip, sd, Vec3::Ones(), 4);
  const auto motion = track(hip.markers, hip.model, {.common_rotation_share = 0.0});
  int inside = 0;
  for (std::size_t f = 0; f < hip.angles.size(); ++f) {
    const HipAngles &a = motion.angles[f], &b = hip.angles[f], &i = motion.interval[f];
    inside += std::abs(a.flexion - b.flexion) < i.flexion;
    inside += std::abs(a.adduction - b.adduction) < i.adduction;
    inside += std::abs(a.internal_rotation - b.internal_rotation) < i.internal_rotation;
  }
  EXPECT_GT(inside, 1800 * 0.90);
  EXPECT_LT(inside, 1800 * 0.99);
}
TEST(CoxaMethod, MarkerPositionsArePutRightByTheFrameTheyWereMeasuredIn) {
  // positions 4 mm off, frame 1 of the recording known to be theirs: what is left is one rotation,
  // whose size the markers' lever arms give
  const auto hip = test::make_hip(200, 0.3);
  Rng rng(8);
  Vec3 with = Vec3::Zero(), without = Vec3::Zero();
  constexpr int kDraws = 8;
  for (int draw = 0; draw < kDraws; ++draw) {
    auto wrong = hip;
    wrong.model.marker_sd = 4.0;
    for (auto& [label, p] : wrong.model.thigh_markers) p += 4.0 * rng.normal3();
    without += error_of(wrong, PoseMethod::coxa).cwiseAbs2() / kDraws;
    wrong.model.calibration_frame = 0;
    with += error_of(wrong, PoseMethod::coxa).cwiseAbs2() / kDraws;
    const auto result = track_in_detail(wrong.markers, wrong.model);
    EXPECT_LE(result.residuals.row(0).maxCoeff(), 1.0);  // camera noise of 0.3 mm is left
  }
  const double expected = best_possible(hip, VecX::Constant(8, 4.0), Vec3::Ones());
  EXPECT_LT(std::sqrt(with.sum()), 1.5 * expected);
  EXPECT_LT(with.sum(), 1.05 * without.sum());
}
TEST(CoxaMethod, IntervalsGrowAwayFromTheCalibrationPose) {
  auto hip = test::make_hip(100);
  add_artefact(hip, VecX::Constant(8, 6.0), Vec3::Ones(), 9);
  hip.model.calibration_frame = 0;
  const auto motion = track(hip.markers, hip.model, {.common_rotation_share = 0.0});
  EXPECT_GT(motion.interval[50].flexion, 1.3 * motion.interval[0].flexion);
}
TEST(CoxaMethod, UsesFramesWithUnseenMarkers) {
  // no frame shows all markers
  VecX sd(8);
  sd << 2, 12, 3, 10, 2, 9, 14, 4;
  auto hip = test::make_hip(400);
  add_artefact(hip, sd, Vec3::Ones(), 6);
  for (Index f = 0; f < 400; ++f)
    hip.markers.trajectories[kFirstThigh + static_cast<std::size_t>(f % 8)].row(f).setConstant(
        kNaN);
  EXPECT_LT(error_of(hip, PoseMethod::coxa).norm(), 1.5 * best_possible(hip, sd, Vec3::Ones()));
  EXPECT_TRUE(track(hip.markers, hip.model).warnings.empty());
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
