#include <coxa/motion/track.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "motion/synthetic_hip.h"

namespace coxa::motion {

using test::make_hip;
using test::rms_error;

class EveryMethod : public ::testing::TestWithParam<PoseMethod> {};
INSTANTIATE_TEST_SUITE_P(Track, EveryMethod, ::testing::ValuesIn(kAllPoseMethods),
                         [](const auto& test) { return std::string(name(test.param)); });

TEST_P(EveryMethod, IsExactForMarkersThatMoveWithTheBones) {
  for (const Side side : {Side::left, Side::right}) {
    const auto hip = make_hip(60, 0.0, side);
    const HipMotion motion = track(hip.markers, hip.model, {.method = GetParam()});
    EXPECT_LE(rms_error(motion, hip.angles).maxCoeff(), 1e-7);
    EXPECT_LE((motion.head_lab - hip.head_lab).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_EQ(motion.method, name(GetParam()));
  }
}
TEST_P(EveryMethod, IsUnchangedByARigidMotionOfTheLaboratory) {
  const auto hip = make_hip(40, 2.0);
  auto moved = hip.markers;
  const RigidTransform X{rotation_from_vector(Vec3(0.4, -1.0, 2.0)), Vec3(500, -300, 20)};
  for (Points& trajectory : moved.trajectories) trajectory = transformed(trajectory, X);
  const auto a = track(hip.markers, hip.model, {.method = GetParam()});
  const auto b = track(moved, hip.model, {.method = GetParam()});
  EXPECT_LE(rms_error(a, b.angles).maxCoeff(), 1e-7);
}
TEST_P(EveryMethod, IsBitIdenticalForOneAndEightThreads) {
  const auto hip = make_hip(64, 2.0);
  const auto run = [&] {
    const HipMotion motion = track(hip.markers, hip.model, {.method = GetParam()});
    std::vector<double> numbers;
    for (const auto& a : motion.angles)
      numbers.insert(numbers.end(), {a.flexion, a.adduction, a.internal_rotation});
    for (const auto& a : motion.interval)
      numbers.insert(numbers.end(), {a.flexion, a.adduction, a.internal_rotation});
    return numbers;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST_P(EveryMethod, BridgesFramesWithoutMarkersAndSaysSo) {
  auto hip = make_hip(200);
  for (Points& trajectory : hip.markers.trajectories)
    trajectory.middleRows(50, 3).setConstant(kNaN);
  const HipMotion motion = track(hip.markers, hip.model, {.method = GetParam()});
  EXPECT_LE(rms_error(motion, hip.angles).maxCoeff(), radians(0.1));
  std::string all;
  for (const auto& warning : motion.warnings) all += warning;
  EXPECT_NE(all.find("3 frames (51-53)"), std::string::npos) << all;
}
TEST_P(EveryMethod, WorksWhereOneMarkerIsUnseen) {
  auto hip = make_hip(30);
  hip.markers.trajectories.back().topRows(10).setConstant(kNaN);
  const auto result = track_in_detail(hip.markers, hip.model, {.method = GetParam()});
  EXPECT_LE(rms_error(result.motion, hip.angles).maxCoeff(), 1e-7);
  EXPECT_TRUE(std::isnan(result.residuals(0, result.residuals.cols() - 1)));
}

TEST(Track, RigidLetsTheHeadGoAndPaperPinsIt) {
  auto hip = make_hip(20);
  for (Points& trajectory : hip.markers.trajectories) {
    if (&trajectory >= &hip.markers.trajectories[4])
      trajectory.rowwise() += Eigen::RowVector3d(0, 12, 0);  // thigh skin slides
  }
  const auto rigid = track(hip.markers, hip.model, {.method = PoseMethod::rigid});
  const auto paper = track(hip.markers, hip.model, {.method = PoseMethod::paper});
  EXPECT_NEAR((rigid.head_lab - hip.head_lab).rowwise().norm().mean(), 12.0, 1e-6);
  EXPECT_LE((paper.head_lab - hip.head_lab).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LE(rms_error(paper, hip.angles).maxCoeff(),
            1e-7);  // a common slide leaves its rotation alone
}
TEST(Track, MaximumLikelihoodTrustsSteadyMarkersMore) {
  auto hip = make_hip(300, 0.5);
  Rng rng(3);
  for (Index f = 0; f < 300; ++f)
    hip.markers.trajectories[6].row(f) += 20.0 * rng.normal3().transpose();
  const auto equal = track_in_detail(hip.markers, hip.model, {.method = PoseMethod::ball_joint});
  const auto weighed =
      track_in_detail(hip.markers, hip.model, {.method = PoseMethod::ball_joint_ml});
  EXPECT_LT(rms_error(weighed.motion, hip.angles).norm(),
            0.3 * rms_error(equal.motion, hip.angles).norm());
  EXPECT_NEAR(weighed.marker_sd[2], 20.0, 2.0);
  EXPECT_TRUE(weighed.report.converged);
}
TEST(Track, IntervalsHoldTheTruthUnderIndependentNoise) {
  const auto hip = make_hip(500, 3.0);
  const auto motion = track(hip.markers, hip.model,
                            {.method = PoseMethod::ball_joint,
                             .joint_translation_sd = 0.0,
                             .common_rotation_share = 0.0});
  int inside = 0;
  for (std::size_t f = 0; f < hip.angles.size(); ++f) {
    inside += std::abs(motion.angles[f].internal_rotation - hip.angles[f].internal_rotation) <
              motion.interval[f].internal_rotation;
    inside +=
        std::abs(motion.angles[f].flexion - hip.angles[f].flexion) < motion.interval[f].flexion;
  }
  EXPECT_GT(inside, 900);
  EXPECT_LT(inside, 995);
}
TEST(Track, IntervalsGrowWithEverySourceOfError) {
  const auto hip = make_hip(50, 1.0);
  const auto width = [&](const HipModel& model, const TrackOptions& options) {
    const auto motion = track(hip.markers, model, options);
    double sum = 0.0;
    for (const auto& a : motion.interval) sum += a.internal_rotation;
    return sum / 50.0;
  };
  const TrackOptions none{
      .method = PoseMethod::ball_joint, .joint_translation_sd = 0.0, .common_rotation_share = 0.0};
  const double least = width(hip.model, none);
  auto options = none;
  options.joint_translation_sd = 2.0;
  EXPECT_GT(width(hip.model, options), least);
  options = none;
  options.common_rotation_share = 0.2;
  EXPECT_GT(width(hip.model, options), least);
  auto model = hip.model;
  model.marker_sd = 2.0;
  EXPECT_GT(width(model, none), least);
  model = hip.model;
  model.pelvis_centre_sd = 3.0;
  EXPECT_GT(width(model, none), least);
  model = hip.model;
  model.femur_centre_sd = 3.0;
  EXPECT_GT(width(model, none), least);
}
TEST(Track, NamesTheMarkersThatAreMissing) {
  auto hip = make_hip(5);
  for (std::size_t m = 4; m < hip.markers.labels.size(); ++m)
    hip.markers.labels[m] = "other_" + std::to_string(m);
  try {
    track(hip.markers, hip.model);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("missing: T0, T1"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("other_5"), std::string::npos);
  }
}
TEST(Track, RefusesModelsThatShowNoRotation) {
  auto hip = make_hip(5);
  double y = 0;
  for (auto& [label, p] : hip.model.thigh_markers) p = Vec3(0, y -= 10, 0);
  EXPECT_THROW(track(hip.markers, hip.model), Error);
}
TEST(Track, ComparesAllMethods) {
  const auto hip = make_hip(20, 1.0);
  const auto results = track_comparison(hip.markers, hip.model);
  ASSERT_EQ(results.size(), std::size(kAllPoseMethods));
  for (std::size_t k = 0; k < results.size(); ++k)
    EXPECT_EQ(results[k].motion.method, name(kAllPoseMethods[k]));
}
TEST(PoseMethod, NamesTheOnesThereAre) {
  EXPECT_EQ(pose_method("paper"), PoseMethod::paper);
  try {
    pose_method("magic");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("ball_joint_ml"), std::string::npos);
  }
}

}  // namespace coxa::motion
