#include <coxa/joint/simulate.h>
#include <gtest/gtest.h>

#include "joint/layers.h"
#include "joint/movements.h"

namespace coxa::joint {
namespace {

FrameResult frame_of(const JointModel& model) {
  const motion::HipMotion at_rest = test::movement_to({}, 1);
  return simulate(model, at_rest, passive_examination(model, 500.0), {.centre_shift = std::nullopt})
      .frames.front();
}

JointModel small_joint() {
  test::BallInCup shape;
  shape.cup_rings = 8;
  shape.head_rings = 11;
  shape.layers = 1;
  return test::make_ball_in_cup(shape);
}

}  // namespace

TEST(ThinEdges, BearNothingWhereThereAreNone) {
  const FrameResult frame = frame_of(small_joint());
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_EQ(frame.thin.force, 0.0);
  EXPECT_EQ(frame.thin.peak_pressure_p99, frame.contact.peak_pressure_p99);
}

TEST(ThinEdges, BearHalfWhereHalfOfTheCupIsThin) {
  // one half is shaved from its bone side to 0.4 mm; the halves' pushes to the side balance, so
  // that each bears half, and the thin one on a smaller part of it
  JointModel shaved = small_joint();
  Points& points = shaved.acetabular_cartilage.points;
  const Vec3 centre = shaved.X_IP.p;
  const double radius = 25.0 + 0.8 * kThinCartilage;
  for (Index i = 0; i < points.rows(); ++i) {
    const Vec3 arm = points.row(i).transpose() - centre;
    if (arm.x() > 0.0 && arm.norm() > radius) points.row(i) = centre + radius * arm.normalized();
  }
  const FrameResult frame = frame_of(shaved);
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  const double all = frame.contact.mean_pressure * frame.contact.contact_area;
  EXPECT_NEAR(frame.thin.force, 0.5 * all, 0.05 * all);
  EXPECT_LT(frame.thin.peak_pressure_p99, 0.9 * frame.contact.peak_pressure_p99);
}

}  // namespace coxa::joint
