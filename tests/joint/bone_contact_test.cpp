#include <coxa/joint/simulate.h>
#include <gtest/gtest.h>

#include "joint/layers.h"
#include "joint/movements.h"
#include "support/shapes.h"

namespace coxa::joint {
namespace {

constexpr double kCavity = 25.2;  // mm, radius of the bone's hollow; the head's is 25 mm

/// A head on a small pad of cartilage in a hollow of bare bone that it does not touch yet.
JointModel on_a_pad() {
  JointModel model = test::make_ball_in_cup(
      {.cup_angle = radians(18.0), .cup_rings = 6, .head_rings = 17, .layers = 1});
  model.hip_bone = test::turned_over(test::icosphere(5, kCavity, Vec3::Zero()));  // bone is outside
  model.femur = test::icosphere(2, 5.0, Vec3::Zero());
  return model;
}

FrameResult pressed(const JointModel& model, double force) {
  const auto motion = test::movement_to({0.0, 0.0, 0.0}, 1);
  return simulate(model, motion, passive_examination(model, force), {.centre_shift = std::nullopt})
      .frames[0];
}

/// How far the femoral cartilage reaches out of the hollow, mm.
double deepest(const JointModel& model, const FrameResult& frame) {
  const Points& points = model.femoral_cartilage.points;
  double deepest = -kInfinity;
  for (Index i = 0; i < points.rows(); ++i) {
    const Vec3 now =
        frame.X_II * Vec3(points.row(i)) + frame.femoral_displacement.row(i).transpose();
    deepest = std::max(deepest, now.norm() - kCavity);
  }
  return deepest;
}

TEST(BoneContact, BareBoneBearsWhatThePadLetsThrough) {
  const JointModel model = on_a_pad();
  const FrameResult frame = pressed(model, 800.0);
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  // the hollow's facets lie up to 0.02 mm inside, and 0.01 mm of overlap is left around a node
  EXPECT_LT(deepest(model, frame), 0.035);
  const double on_bone = frame.balance.force_on_bone.z();
  EXPECT_GT(on_bone, 50.0);
  EXPECT_LT(on_bone, 700.0);
  EXPECT_NEAR(frame.balance.contact_force.z(), 800.0, 1.0);
  // three ways to the part on the pad: its reaction, its pressures, and the rest of the force
  EXPECT_NEAR(frame.balance.socket_reaction.z(), 800.0 - on_bone, 2.0);
  EXPECT_NEAR(frame.contact.mean_pressure * frame.contact.contact_area, 800.0 - on_bone, 40.0);
  EXPECT_LT(frame.balance.reaction_error, 1e-3);
}
TEST(BoneContact, WithoutBonesTheHeadGoesThroughTheHollow) {
  JointModel model = on_a_pad();
  model.hip_bone = model.femur = {};
  const FrameResult frame = pressed(model, 800.0);
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_GT(deepest(model, frame), 0.1);
  EXPECT_EQ(frame.balance.force_on_bone.norm(), 0.0);
}
TEST(BoneContact, IsOffWhereTheBoneIsNotReached) {
  const JointModel model = on_a_pad();
  const FrameResult frame = pressed(model, 20.0);
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_EQ(frame.balance.force_on_bone.norm(), 0.0);
}

}  // namespace
}  // namespace coxa::joint
