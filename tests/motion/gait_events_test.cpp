#include <coxa/motion/gait_events.h>

#include <coxa/geom/fits.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::motion {
namespace {

// Both feet swing about a pelvis that walks at `speed` along x, z up; strides of 1.1 s. The heel is
// farthest in front when cos = 1, the toe farthest behind when cos = -1.
MarkerData walking(double speed, double way) {
  MarkerData markers;
  markers.rate = 100.0;
  markers.first_time = 2.0;
  constexpr Index kFrames = 400;
  const auto add = [&](const char* label, const auto& place) {
    Points path(kFrames, 3);
    for (Index f = 0; f < kFrames; ++f)
      path.row(f) = place(f / 100.0) + Vec3(speed * f / 100.0, 0, 0);
    markers.labels.push_back(label);
    markers.trajectories.push_back(path);
  };
  add("SACR", [](double t) { return Vec3(0, 0, 950 + 15 * std::sin(11.4 * t)); });
  for (const auto& [letter, phase, y] : {std::tuple{'L', 0.0, 90.0}, std::tuple{'R', kPi, -90.0}}) {
    const auto swing = [=](double t) { return std::cos(2 * kPi * t / 1.1 + phase); };
    add(letter == 'L' ? "LHEE" : "RHEE",
        [=](double t) { return Vec3(0.5 * way * swing(t), y, 60 + 40 * swing(t) * swing(t)); });
    add(letter == 'L' ? "LTOE" : "RTOE",
        [=](double t) { return Vec3(170 + 0.5 * way * swing(t), y, 50); });
  }
  return markers;
}

}  // namespace

TEST(GaitEvents, AreFoundOvergroundAndOnATreadmill) {
  for (const double speed : {1250.0, 0.0}) {
    const FoundEvents found = find_gait_events(walking(speed, 650.0));
    EXPECT_EQ(found.reason, "");
    // 4 s: three of each kind that are not at an end
    ASSERT_EQ(found.events.size(), 12U);
    for (const MarkerEvent& event : found.events) {
      const bool left = event.context == "Left", strike = event.label == "Foot Strike";
      const double turns = (event.time - 2.0) / 1.1 + (left == strike ? 0.0 : 0.5);
      EXPECT_NEAR(turns, std::round(turns), 0.005) << event.label << " " << event.context;
      EXPECT_EQ(event.source, "heel and toe (Zeni 2008)");
    }
  }
}
TEST(GaitEvents, SayWhyThereAreNone) {
  MarkerData markers = walking(1250.0, 650.0);
  markers.labels[0] = "C7";
  EXPECT_EQ(find_gait_events(markers).reason, "no marker of the sacrum or of both PSIS");
  markers = walking(1250.0, 650.0);
  markers.labels[1] = markers.labels[4] = "else";
  EXPECT_EQ(find_gait_events(markers).reason, "no foot with markers of heel and toe");
  EXPECT_EQ(find_gait_events(walking(0.0, 100.0)).reason,
            "no heel passes the pelvis as in walking");
  // a squat: the pelvis goes down, the feet stay
  markers = walking(0.0, 5.0);
  for (Index f = 0; f < 400; ++f) markers.trajectories[0](f, 2) -= 400 * std::sin(f / 60.0);
  EXPECT_EQ(find_gait_events(markers).reason, "the heels do not move along the feet: no walking");
}

}  // namespace coxa::motion
