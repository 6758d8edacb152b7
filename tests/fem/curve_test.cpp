#include <coxa/fem/curve.h>

#include <coxa/core/error.h>
#include <coxa/core/types.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::fem {

const Curve kToe({-0.5, 0.0, 0.1, 0.2, 0.4}, {-3.0, 0.0, 0.05, 0.4, 3.0});

TEST(Curve, PassesThroughItsPointsAndGoesOnStraight) {
  EXPECT_NEAR(kToe.value(-0.5), -3.0, 1e-15);
  EXPECT_NEAR(kToe.value(0.1), 0.05, 1e-15);
  EXPECT_NEAR(kToe.value(0.4), 3.0, 1e-15);
  EXPECT_NEAR(kToe.value(0.6) - kToe.value(0.5), kToe.value(0.5) - kToe.value(0.4), 1e-12);
  EXPECT_NEAR(kToe.slope(0.7), kToe.slope(0.4), 1e-15);
}
TEST(Curve, HasTheSlopeAndTheIntegralOfItsValue) {
  constexpr double h = 1e-6;
  for (double x = -0.8; x < 0.8; x += 0.0137) {
    EXPECT_NEAR(kToe.slope(x), (kToe.value(x + h) - kToe.value(x - h)) / (2 * h), 1e-5) << x;
    EXPECT_NEAR(kToe.value(x), (kToe.integral(x + h) - kToe.integral(x - h)) / (2 * h), 1e-8) << x;
  }
  EXPECT_EQ(kToe.integral(0.0), 0.0);
}
TEST(Curve, HasAContinuousSlopeAndRisesWhereItsPointsRise) {
  for (const double x : {-0.5, 0.0, 0.1, 0.2, 0.4})
    EXPECT_NEAR(kToe.slope(x - 1e-12), kToe.slope(x + 1e-12), 1e-9);
  for (double x = -1.0; x < 1.0; x += 0.001) EXPECT_GE(kToe.slope(x), 0.0);
}
TEST(Curve, IsFlatBetweenEqualPoints) {
  const Curve step({0, 1, 2, 3}, {0, 1, 1, 5});
  EXPECT_NEAR(step.value(1.5), 1.0, 1e-15);
  EXPECT_NEAR(step.slope(1.5), 0.0, 1e-15);
}
TEST(Curve, CanBeALine) {
  const Curve line = Curve::line(3.0);
  for (const double x : {-7.0, -0.5, 0.0, 0.3, 9.0}) {
    EXPECT_NEAR(line.value(x), 3.0 * x, 1e-13);
    EXPECT_NEAR(line.integral(x), 1.5 * x * x, 1e-12);
  }
}
TEST(Curve, RejectsPointsThatDoNotMakeACurve) {
  EXPECT_THROW(Curve({0.0}, {0.0}), Error);
  EXPECT_THROW(Curve({0.0, 1.0}, {0.0}), Error);
  EXPECT_THROW(Curve({0.0, kNaN}, {0.0, 1.0}), Error);
  try {
    Curve({0.0, 2.0, 1.0}, {0.0, 1.0, 2.0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "point 2 of a curve does not ascend: 1 after 2");
  }
}

}  // namespace coxa::fem
