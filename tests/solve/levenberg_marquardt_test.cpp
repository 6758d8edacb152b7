#include <coxa/solve/levenberg_marquardt.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::solve {

LeastSquares rosenbrock() {
  return {[](const VecX& x) { return VecX(Vec2(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0])); },
          [](const VecX& x) {
            MatX J(2, 2);
            J << -20.0 * x[0], 10.0, -1.0, 0.0;
            return J;
          }};
}

// samples of 2 exp(-0.7 t) + 0.5
LeastSquares decay() {
  return {[](const VecX& x) {
            VecX r(30);
            for (int i = 0; i < 30; ++i) {
              const double t = 0.2 * i;
              r[i] = x[0] * std::exp(-x[1] * t) + x[2] - (2.0 * std::exp(-0.7 * t) + 0.5);
            }
            return r;
          },
          {}};
}

TEST(LevenbergMarquardt, FindsTheMinimumOfRosenbrocksValley) {
  VecX x = Vec2(-1.2, 1.0);
  const SolveReport report = levenberg_marquardt(rosenbrock(), x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_LE((x - Vec2(1, 1)).norm(), 1e-9);
  EXPECT_LE(report.iterations, 50);
}
TEST(LevenbergMarquardt, RecoversADecayWithoutAGivenJacobian) {
  VecX x = Vec3(1.0, 0.1, 0.0);
  const SolveReport report = levenberg_marquardt(decay(), x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_LE((x - Vec3(2.0, 0.7, 0.5)).norm(), 1e-7);
}
TEST(LevenbergMarquardt, GivesTheLinearLeastSquaresSolutionWithResidualLeft) {
  const LeastSquares line{
      [](const VecX& x) {
        return VecX(Vec3(x[0] - 1.0, x[0] + x[1] - 3.0, x[0] + 2.0 * x[1] - 2.0));
      },
      {}};
  VecX x = Vec2(50.0, -30.0);
  EXPECT_TRUE(levenberg_marquardt(line, x).converged);
  EXPECT_NEAR(x[0], 1.5, 1e-8);
  EXPECT_NEAR(x[1], 0.5, 1e-8);
}
TEST(LevenbergMarquardt, SurvivesAnUnknownWithoutEffect) {
  const LeastSquares one{[](const VecX& x) { return VecX(VecX::Constant(1, x[0] - 4.0)); }, {}};
  VecX x = Vec2(0.0, 7.0);
  EXPECT_TRUE(levenberg_marquardt(one, x).converged);
  EXPECT_NEAR(x[0], 4.0, 1e-8);
  EXPECT_NEAR(x[1], 7.0, 1e-12);
}
TEST(LevenbergMarquardt, StaysWhereTheResidualsAreNumbers) {
  const LeastSquares root{[](const VecX& x) { return VecX(VecX::Constant(1, std::log(x[0]))); },
                          {}};
  VecX x = VecX::Constant(1, 5.0);  // the undamped step would go below zero
  EXPECT_TRUE(levenberg_marquardt(root, x).converged);
  EXPECT_NEAR(x[0], 1.0, 1e-9);
}
TEST(LevenbergMarquardt, NumericJacobianMatchesTheGivenOne) {
  const VecX x = Vec2(0.3, -2.0);
  EXPECT_LE((numeric_jacobian(rosenbrock().residuals, x) - rosenbrock().jacobian(x)).norm(), 1e-8);
}
TEST(LevenbergMarquardt, SaysWhenIterationsRunOut) {
  VecX x = Vec2(-1.2, 1.0);
  const SolveReport report = levenberg_marquardt(rosenbrock(), x, {.max_iterations = 3});
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.reason, "not converged after 3 iterations");
}
TEST(LevenbergMarquardt, MoreInitialDampingTakesAShorterFirstStep) {
  const LeastSquares one{[](const VecX& x) { return VecX(VecX::Constant(1, x[0] - 4.0)); }, {}};
  VecX x = VecX::Zero(1);
  levenberg_marquardt(one, x, {.max_iterations = 1, .initial_damping = 1.0});
  EXPECT_NEAR(x[0], 2.0, 1e-6);  // 4 / (1 + damping)
}
TEST(LevenbergMarquardt, RejectsAStartWithoutValueAndBadOptions) {
  VecX x = VecX::Constant(1, kNaN);
  EXPECT_THROW(levenberg_marquardt(decay(), x = Vec3(kNaN, 0, 0)), Error);
  x = Vec2(0, 0);
  EXPECT_THROW(levenberg_marquardt(rosenbrock(), x, {.tolerance = 2.0}), Error);
  EXPECT_THROW(levenberg_marquardt(rosenbrock(), x, {.max_iterations = 0}), Error);
  EXPECT_THROW(levenberg_marquardt(rosenbrock(), x, {.initial_damping = 0.0}), Error);
}

}  // namespace coxa::solve
