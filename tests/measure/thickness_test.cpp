#include <coxa/measure/thickness.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace coxa::measure {

const TriMesh bone = test::plate(/*z=*/0.0), cartilage = test::plate(2.0);
const auto thickness = [] { return cartilage_thickness(bone, cartilage); };

TEST(CartilageThickness, EqualsTheGapBetweenParallelPlates) {
  EXPECT_LE((thickness().array() - 2.0).abs().maxCoeff(), 1e-12);
}
TEST(CartilageThickness, IsUnchangedByARigidMotion) {
  // a larger articular plate: at its border rounding decides whether a ray still hits
  const TriMesh larger = test::plate(2.0, 11.0);
  const auto X = test::some_pose();
  const auto moved = cartilage_thickness(test::moved(bone, X), test::moved(larger, X));
  EXPECT_LE((moved.array() - 2.0).abs().maxCoeff(), 1e-9);
}
TEST(CartilageThickness, OfAShellIsTheDifferenceOfTheRadii) {
  const auto shell = cartilage_thickness(test::icosphere(3, 10.0), test::icosphere(4, 12.0));
  EXPECT_LE((shell.array() - 2.0).abs().maxCoeff(), 0.02);
}
TEST(CartilageThickness, IsNaNWhereNoCartilageCoversTheBone) {
  EXPECT_TRUE(cartilage_thickness(bone, cartilage, {.max_thickness = 1.0}).array().isNaN().all());
}
TEST(CartilageThickness, RayOffsetSkipsASurfaceThatTouchesTheBone) {
  EXPECT_LE(cartilage_thickness(bone, bone, {.ray_offset = 0.0}).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(cartilage_thickness(bone, bone, {.ray_offset = 0.1}).array().isNaN().all());
}
TEST(CartilageThickness, IsBitIdenticalForOneAndEightThreads) {
  EXPECT_EQ(with_threads(1, thickness), with_threads(8, thickness));
}
TEST(CartilageThickness, RejectsALimitBelowTheRayOffset) {
  EXPECT_THROW(cartilage_thickness(bone, cartilage, {.max_thickness = 0.0}), Error);
}
TEST(CartilageThickness, RejectsAnEmptyMesh) {
  EXPECT_THROW(cartilage_thickness(bone, TriMesh{}), Error);
}

TEST(ClosedCartilageThickness, IsTheFarSideOfABoxLyingALittleOffTheBone) {
  const TriMesh layer = test::box(Vec3(-20, -20, 0.2), Vec3(20, 20, 1.7));
  EXPECT_LE((closed_cartilage_thickness(bone, layer).array() - 1.7).abs().maxCoeff(), 1e-9);
}
TEST(ClosedCartilageThickness, IsTheFarSideOfABoxThatReachesIntoTheBone) {
  const TriMesh layer = test::box(Vec3(-20, -20, -0.2), Vec3(20, 20, 1.7));
  EXPECT_LE((closed_cartilage_thickness(bone, layer).array() - 1.7).abs().maxCoeff(), 1e-9);
}
TEST(ClosedCartilageThickness, IsNaNBesideTheCartilage) {
  const TriMesh layer = test::box(Vec3(100, 100, 0.2), Vec3(120, 120, 1.7));
  EXPECT_TRUE(closed_cartilage_thickness(bone, layer).array().isNaN().all());
}

}  // namespace coxa::measure
