#include <coxa/segment/layer_search.h>

#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

/// Bone side 0.3 mm above a ball of radius 20, articular side 1.7 mm above that.
Points shell() {
  const Points directions = test::icosphere(3, 1.0).points;
  Points points(2 * directions.rows(), 3);
  points << 20.3 * directions, 22.0 * directions;
  return points;
}

TEST(LaidOn, KeepsTheThicknessAndClosesTheGap) {
  const TriMesh ball = test::icosphere(4, 20.0), bigger = test::icosphere(4, 25.0);
  const RigidTransform X = test::some_pose();
  const Points points = shell();
  const auto n = static_cast<Index>(points.rows() / 2);
  const Points laid = laid_on(points, n, ball, test::moved(bigger, X), 0.1);
  for (Index v = 0; v < n; ++v) {
    EXPECT_NEAR((X.inverse() * Vec3(laid.row(v).transpose())).norm(), 25.1, 0.06);
    EXPECT_NEAR((laid.row(v + n) - laid.row(v)).norm(), 1.7, 1e-9);
  }
}

TEST(LaidOn, OnItsOwnMeanOnlyTheGapChanges) {
  const TriMesh ball = test::icosphere(4, 20.0);
  const Points points = shell();
  const auto n = static_cast<Index>(points.rows() / 2);
  const Points laid = laid_on(points, n, ball, ball, 0.3);
  EXPECT_LT((laid - points).rowwise().norm().maxCoeff(), 0.06);
}

}  // namespace
}  // namespace coxa::segment
