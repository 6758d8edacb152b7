#include <coxa/motion/hip_motion.h>

#include <coxa/core/rng.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

namespace coxa::motion {

TEST(HipAngles, ReturnFromTheirRotation) {
  Rng rng(1);
  for (int k = 0; k < 200; ++k) {
    const HipAngles a{rng.uniform(-2, 2), rng.uniform(-1.5, 1.5), rng.uniform(-2, 2)};
    for (const Side side : {Side::left, Side::right}) {
      const Mat3 R = rotation_from_angles(a, side);
      EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
      const HipAngles b = angles_from_rotation(R, side);
      EXPECT_NEAR(a.flexion, b.flexion, 1e-12);
      EXPECT_NEAR(a.adduction, b.adduction, 1e-12);
      EXPECT_NEAR(a.internal_rotation, b.internal_rotation, 1e-12);
    }
  }
}
TEST(HipAngles, FlexionBringsTheKneeForward) {
  const Mat3 R = rotation_from_angles({.flexion = radians(90)}, Side::right);
  EXPECT_LE((R * Vec3(0, -1, 0) - Vec3(1, 0, 0)).norm(),
            1e-12);  // the knee hangs at -y, x is anterior
}
TEST(HipAngles, AdductionBringsTheKneeToTheMidlineOnBothSides) {
  const HipAngles a{.adduction = radians(30)};
  EXPECT_LT((rotation_from_angles(a, Side::right) * Vec3(0, -1, 0)).z(), -0.4);  // z is right
  EXPECT_GT((rotation_from_angles(a, Side::left) * Vec3(0, -1, 0)).z(), 0.4);
}
TEST(HipAngles, InternalRotationTurnsTheToesInOnBothSides) {
  const HipAngles a{.internal_rotation = radians(30)};
  EXPECT_LT((rotation_from_angles(a, Side::right) * Vec3(1, 0, 0)).z(), -0.4);  // toes point to +x
  EXPECT_GT((rotation_from_angles(a, Side::left) * Vec3(1, 0, 0)).z(), 0.4);
}
TEST(HipAngles, OfTheMirroredHipAreTheSame) {
  const HipAngles a{0.7, 0.2, -0.4};
  const Mat3 mirror = Vec3(1, 1, -1).asDiagonal();
  const Mat3 left = mirror * rotation_from_angles(a, Side::right) * mirror;
  EXPECT_LE((left - rotation_from_angles(a, Side::left)).norm(), 1e-12);
}

}  // namespace coxa::motion
