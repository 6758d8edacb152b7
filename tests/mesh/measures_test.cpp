#include <coxa/mesh/measures.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TEST(Measures, OfABoxAreExact) {
  const TriMesh box = test::box(Vec3(1, 2, 3), Vec3(3, 5, 7));
  EXPECT_NEAR(area(box), 2 * (6 + 8 + 12), 1e-12);
  EXPECT_NEAR(volume(box), 24.0, 1e-12);
  EXPECT_LE((volume_centroid(box) - Vec3(2, 3.5, 5)).norm(), 1e-12);
  EXPECT_EQ(bounds(box.points).low, Vec3(1, 2, 3));
  EXPECT_EQ(bounds(box.points).high, Vec3(3, 5, 7));
  EXPECT_NEAR(bounds(box.points).diagonal(), std::sqrt(29.0), 1e-14);
}
TEST(Measures, OfASphereTendToTheClosedForm) {
  const TriMesh sphere = test::icosphere(5);
  EXPECT_NEAR(area(sphere), 4 * kPi * 100, 4 * kPi * 100 * 1e-3);
  EXPECT_NEAR(volume(sphere), 4 * kPi / 3 * 1000, 4 * kPi / 3 * 1000 * 2e-3);
}
TEST(Measures, KeepUnderRigidMotionAndFlipSignInside) {
  TriMesh torus = test::torus();
  const TriMesh moved = test::moved(torus, test::some_pose());
  EXPECT_NEAR(volume(moved), volume(torus), 1e-9);
  EXPECT_LE((volume_centroid(moved) - test::some_pose() * volume_centroid(torus)).norm(), 1e-10);
  torus.triangles.col(0).swap(torus.triangles.col(1));
  EXPECT_NEAR(volume(torus), -volume(moved), 1e-9);
}
TEST(Measures, MeanEdgeOfAUnitCellIsItsSidesAndDiagonal) {
  EXPECT_NEAR(mean_edge_length(test::plate(0.0, 0.5, 1)), (2.0 + std::sqrt(2.0)) / 3.0, 1e-14);
}
TEST(Measures, RejectEmptyMeshes) {
  EXPECT_THROW(mean_edge_length({}), Error);
  EXPECT_THROW(bounds(Points(0, 3)), Error);
  EXPECT_THROW(volume_centroid({}), Error);
}

}  // namespace coxa
