#include <coxa/motion/marker_cleaning.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "motion/synthetic_hip.h"

namespace coxa::motion {
namespace {

const std::vector<std::string> kThigh = {"T0", "T1", "T2", "T3", "T4", "T5", "T6", "T7"};
Points& path(MarkerData& markers, const std::string& label) {
  return markers.trajectories[static_cast<std::size_t>(*find_marker(markers, label))];
}
double difference(const MarkerData& a, const MarkerData& b) {
  double largest = 0.0;
  for (std::size_t m = 0; m < a.trajectories.size(); ++m) {
    largest = std::max(largest, (a.trajectories[m] - b.trajectories[m]).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace

TEST(MarkerCleaning, LeavesACleanRecordingAlone) {
  const auto hip = test::make_hip(100);
  const auto cleaned = clean_markers(hip.markers, {.segments = {kThigh}});
  EXPECT_EQ(difference(cleaned.markers, hip.markers), 0.0);
  EXPECT_TRUE(cleaned.gaps.empty() && cleaned.swaps.empty() && cleaned.jumps.empty());
}
TEST(MarkerCleaning, CarriesAMarkerOverAGapWithItsSegment) {
  const auto hip = test::make_hip(100);
  auto markers = hip.markers;
  path(markers, "T3").middleRows(30, 20).setConstant(kNaN);
  const auto cleaned = clean_markers(markers, {.segments = {kThigh}});
  ASSERT_EQ(cleaned.gaps.size(), 1u);
  EXPECT_EQ(cleaned.gaps[0].fill, MarkerGap::Fill::rigid);
  EXPECT_EQ(cleaned.gaps[0].begin, 30);
  EXPECT_EQ(cleaned.gaps[0].end, 50);
  EXPECT_LE(difference(cleaned.markers, hip.markers), 1e-6);
}
TEST(MarkerCleaning, DrawsACurveWhereNothingCarriesTheMarker) {
  const auto hip = test::make_hip(200);
  auto markers = hip.markers;
  path(markers, "T3").middleRows(30, 8).setConstant(kNaN);
  const auto cleaned = clean_markers(markers);
  EXPECT_EQ(cleaned.gaps.at(0).fill, MarkerGap::Fill::curve);
  EXPECT_LE(difference(cleaned.markers, hip.markers), 3.0);
}
TEST(MarkerCleaning, LeavesLongGapsOpenAndReportsThem) {
  auto markers = test::make_hip(200).markers;
  path(markers, "T3").middleRows(30, 26).setConstant(kNaN);
  path(markers, "T4").topRows(5).setConstant(kNaN);
  const auto cleaned = clean_markers(markers, {.segments = {kThigh}});
  ASSERT_EQ(cleaned.gaps.size(), 2u);
  for (const auto& gap : cleaned.gaps) EXPECT_EQ(gap.fill, MarkerGap::Fill::none);
  EXPECT_EQ(cleaned.markers.warnings.back(), "31 marker positions are missing");
  EXPECT_EQ(clean_markers(markers, {.longest_gap = 0.3, .segments = {kThigh}}).gaps[0].fill,
            MarkerGap::Fill::rigid);
}
TEST(MarkerCleaning, PutsExchangedLabelsRight) {
  const auto hip = test::make_hip(100);
  auto markers = hip.markers;
  const Points tail = path(markers, "T1").middleRows(40, 30);
  path(markers, "T1").middleRows(40, 30) = path(markers, "T5").middleRows(40, 30);
  path(markers, "T5").middleRows(40, 30) = tail;
  const auto cleaned = clean_markers(markers, {.segments = {kThigh}});
  EXPECT_EQ(difference(cleaned.markers, hip.markers), 0.0);
  ASSERT_EQ(cleaned.swaps.size(), 2u);
  EXPECT_EQ(cleaned.swaps[0], "T1 and T5 from frame 41 (0.4 s) on");
}
TEST(MarkerCleaning, TakesSpikesOutAndFillsThem) {
  const auto hip = test::make_hip(100);
  auto markers = hip.markers;
  path(markers, "T2").middleRows(50, 3).array() += 60.0;
  const auto cleaned = clean_markers(markers, {.segments = {kThigh}});
  ASSERT_EQ(cleaned.jumps.size(), 1u);
  EXPECT_NE(cleaned.jumps[0].find("T2 in frame 51"), std::string::npos);
  EXPECT_NE(cleaned.jumps[0].find("taken out"), std::string::npos);
  EXPECT_LE(difference(cleaned.markers, hip.markers), 1e-6);
  EXPECT_TRUE(clean_markers(markers, {.jump = 200.0, .segments = {kThigh}}).jumps.empty());
}
TEST(MarkerCleaning, OnlyReportsAStepThatStays) {
  auto markers = test::make_hip(100).markers;
  path(markers, "T2").bottomRows(50).array() += 60.0;
  const auto cleaned = clean_markers(markers, {.segments = {kThigh}});
  ASSERT_EQ(cleaned.jumps.size(), 1u);
  EXPECT_NE(cleaned.jumps[0].find("left as it is"), std::string::npos);
  EXPECT_EQ(difference(cleaned.markers, markers), 0.0);
}
TEST(LowPass, KeepsSlowAndRemovesFastMovement) {
  const Index n = 400;
  const double rate = 100.0;
  const auto sine = [&](double hz) {
    Points p(n, 3);
    for (Index f = 0; f < n; ++f) p.row(f).setConstant(std::sin(2 * kPi * hz * f / rate));
    return p;
  };
  const auto middle = [&](const Points& p) { return Points(p.middleRows(100, 200)); };
  EXPECT_LE((middle(low_pass(sine(0.5), rate, 6.0)) - middle(sine(0.5))).cwiseAbs().maxCoeff(),
            1e-3);
  EXPECT_LE(middle(low_pass(sine(25.0), rate, 6.0)).cwiseAbs().maxCoeff(), 0.01);
  // half power (-3 dB) at the cut-off itself
  EXPECT_NEAR(middle(low_pass(sine(6.0), rate, 6.0)).cwiseAbs().maxCoeff(), std::sqrt(0.5), 0.03);
  EXPECT_THROW(low_pass(sine(1.0), rate, 50.0), Error);
}
TEST(LowPass, LeavesAStraightLineAlone) {
  Points p(60, 3);
  for (Index f = 0; f < 60; ++f) p.row(f).setConstant(3.0 * f + 7.0);
  EXPECT_LE((low_pass(p, 100.0, 6.0) - p).cwiseAbs().maxCoeff(), 0.05);
}

}  // namespace coxa::motion
