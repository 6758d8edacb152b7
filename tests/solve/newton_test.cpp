#include <coxa/solve/newton.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::solve {

// energy sqrt(1 + x^2): the full Newton step diverges from |x| > 1
NewtonProblem square_root() {
  return {[](const VecX& x) { return VecX(-x.array() / (1.0 + x.array().square()).sqrt()); },
          [](const VecX& x, const VecX& r) {
            return VecX(r.array() * (1.0 + x.array().square()).pow(1.5));
          },
          [](const VecX& x) { return (1.0 + x.array().square()).sqrt().sum(); }};
}

TEST(Newton, ConvergesWhereTheFullStepDiverges) {
  VecX x = VecX::Constant(1, 3.0);
  const SolveReport report = newton(square_root(), x, {.tolerance = 1e-12});
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_NEAR(x[0], 0.0, 1e-12);
}
TEST(Newton, SearchesOnTheResidualWithoutEnergy) {
  NewtonProblem problem = square_root();
  problem.energy = {};
  VecX x = VecX::Constant(1, 3.0);
  EXPECT_FALSE(newton(problem, x, {.max_halvings = 0}).converged);
  x[0] = 3.0;
  EXPECT_TRUE(newton(problem, x).converged);
}
TEST(Newton, StaysOutOfForbiddenPlaces) {
  // energy -log(x) + x, forbidden for x <= 0
  const NewtonProblem barrier{
      [](const VecX& x) { return VecX(1.0 / x.array() - 1.0); },
      [](const VecX& x, const VecX& r) { return VecX(r.array() * x.array().square()); },
      [](const VecX& x) { return x[0] > 0.0 ? x[0] - std::log(x[0]) : kInfinity; }};
  VecX x = VecX::Constant(1, 5.0);
  EXPECT_TRUE(newton(barrier, x, {.tolerance = 1e-12}).converged);
  EXPECT_NEAR(x[0], 1.0, 1e-10);
  x[0] = -1.0;
  EXPECT_EQ(newton(barrier, x).reason, "the energy is infinite at the start");
}
TEST(Newton, LimitsTheLengthOfAStepOnRequest) {
  VecX x = VecX::Constant(1, 0.9);
  const SolveReport report = newton(square_root(), x, {.max_iterations = 1, .max_step = 0.01});
  EXPECT_EQ(report.iterations, 1);
  EXPECT_NEAR(x[0], 0.89, 1e-12);
}
TEST(Newton, MeasuresTheResidualInUnitsOfTheScale) {
  VecX x = VecX::Constant(1, 0.5);
  const SolveReport report = newton(square_root(), x, {.scale = 100.0, .max_iterations = 0});
  EXPECT_NEAR(report.residual, 0.5 / std::sqrt(1.25) / 100.0, 1e-15);
  EXPECT_FALSE(report.converged);
}
TEST(Newton, SaysWhenAStepDoesNotDescend) {
  NewtonProblem problem = square_root();
  problem.step = [](const VecX&, const VecX& r) { return VecX(-r); };
  VecX x = VecX::Constant(1, 1.0);
  EXPECT_EQ(newton(problem, x).reason, "the linear solve gave no direction of descent");
  problem.energy = {};
  EXPECT_NE(newton(problem, x).reason.find("line search found no progress"), std::string::npos);
}
TEST(Newton, RejectsBadOptions) {
  VecX x = VecX::Zero(1);
  EXPECT_THROW(newton(square_root(), x, {.tolerance = 0.0}), Error);
  EXPECT_THROW(newton(square_root(), x, {.scale = 0.0}), Error);
  EXPECT_THROW(newton(square_root(), x, {.max_iterations = -1}), Error);
  EXPECT_THROW(newton(square_root(), x, {.max_halvings = -1}), Error);
  EXPECT_THROW(newton(square_root(), x, {.max_step = -1.0}), Error);
}

}  // namespace coxa::solve
