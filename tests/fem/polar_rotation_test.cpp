#include "../../src/fem/polar_rotation.h"

#include <coxa/core/rng.h>
#include <coxa/fem/signed_svd.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "fem/shapes.h"

namespace coxa::fem {
namespace {

TEST(PolarRotation, IsTheRotationOfTheSignedSingularValues) {
  Rng rng(11);
  int inverted = 0, left_out = 0;
  for (int k = 0; k < 2000; ++k) {
    const Mat3 F = Mat3::Identity() + (k % 2 == 0 ? 0.05 : 0.8) * test::random_matrix(rng);
    const SignedSvd svd = signed_svd(F);
    const auto R = polar_rotation(F);
    if (!R) {
      ++left_out;
      continue;
    }
    if (F.determinant() < 0.0) ++inverted;
    EXPECT_LT((*R - svd.U * svd.V.transpose()).norm(), 1e-10);
    EXPECT_LT((R->transpose() * *R - Mat3::Identity()).norm(), 1e-10);
  }
  EXPECT_GT(inverted, 20);
  EXPECT_LT(left_out, 200);
}

TEST(PolarRotation, IsExactForEqualAndForVanishingStretches) {
  Rng rng(3);
  const Mat3 R = signed_svd(test::random_matrix(rng)).U;
  for (const Vec3& stretch : {Vec3(1, 1, 1), Vec3(2, 2, 2), Vec3(1, 1, 0.5), Vec3(1, 1, 0),
                              Vec3(1e-3, 1e-3, 2e-3), Vec3(1, 0.8, -0.1)}) {
    const auto found = polar_rotation(R * stretch.asDiagonal());
    ASSERT_TRUE(found.has_value()) << stretch.transpose();
    EXPECT_LT((*found - R).norm(), 1e-12) << stretch.transpose();
  }
}

TEST(PolarRotation, IsNotGivenWhereTwoStretchesCancel) {
  EXPECT_FALSE(polar_rotation(Vec3(1, 0.5, -0.5).asDiagonal()).has_value());
  EXPECT_FALSE(polar_rotation(Vec3(1, 0, 0).asDiagonal()).has_value());
  EXPECT_FALSE(polar_rotation(Mat3::Zero()).has_value());
}

}  // namespace
}  // namespace coxa::fem
