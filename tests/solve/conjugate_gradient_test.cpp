#include <coxa/solve/conjugate_gradient.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "solve/systems.h"

namespace coxa::solve {

// particle 2 is fixed, particle 5 slides in the plane normal to (1, 1, 0)
void hold_two(VecX& values) {
  values.segment<3>(6).setZero();
  const Vec3 normal = Vec3(1, 1, 0).normalized();
  values.segment<3>(15) -= normal * normal.dot(values.segment<3>(15));
}

TEST(ConjugateGradient, EqualsTheDenseSolution) {
  const BlockMatrix A = test::ring_matrix(40);
  const VecX b = test::random_vector(120, 5);
  VecX x = test::random_vector(120, 6);
  const SolveReport report = conjugate_gradient(A, b, x, {.tolerance = 1e-12});
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_LE((x - test::dense(A).ldlt().solve(b)).norm(), 1e-9 * x.norm());
}
TEST(ConjugateGradient, MeetsItsToleranceInTheTrueResidual) {
  const BlockMatrix A = test::ring_matrix(300);
  const VecX b = test::random_vector(900, 5);
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    VecX x = VecX::Zero(900), Ax;
    const SolveReport report = conjugate_gradient(A, b, x, {.tolerance = tolerance});
    A.multiply(x, Ax);
    EXPECT_LE((b - Ax).norm() / b.norm(), 1.01 * tolerance);
    EXPECT_TRUE(report.converged);
  }
}
TEST(ConjugateGradient, SolvesInTheAllowedSpaceAndKeepsThePrescribedPart) {
  const BlockMatrix A = test::ring_matrix(12);
  const VecX b = test::random_vector(36, 8);
  VecX prescribed = VecX::Zero(36);
  prescribed.segment<3>(6) = Vec3(0.1, -0.2, 0.3);
  VecX x = prescribed;
  const SolveReport report = conjugate_gradient(A, b, x, {.tolerance = 1e-12}, hold_two);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_EQ(x.segment<3>(6), Vec3(0.1, -0.2, 0.3));
  EXPECT_NEAR(x.segment<3>(15).dot(Vec3(1, 1, 0)), 0.0, 1e-14);
  VecX residual = b - test::dense(A) * x;
  hold_two(residual);
  EXPECT_LE(residual.norm(), 1e-10);
}
TEST(ConjugateGradient, TakesNoIterationFromTheSolution) {
  const BlockMatrix A = test::ring_matrix(10);
  VecX x = test::random_vector(30, 4), b;
  A.multiply(x, b);
  const VecX start = x;
  const SolveReport report = conjugate_gradient(A, b, x, {.tolerance = 1e-10});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(x, start);
}
TEST(ConjugateGradient, StopsAtNegativeCurvatureAndSaysSo) {
  BlockMatrix A = test::ring_matrix(10);
  A.at(4, 4) -= 1e4 * Mat3::Identity();
  VecX x = VecX::Zero(30);
  const SolveReport report = conjugate_gradient(A, test::random_vector(30, 4), x);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.reason, "direction of non-positive curvature");
  EXPECT_TRUE(x.allFinite());
}
TEST(ConjugateGradient, SaysWhenIterationsRunOut) {
  const BlockMatrix A = test::ring_matrix(200, 1, 1e-6);
  VecX x = VecX::Zero(600);
  const SolveReport report = conjugate_gradient(A, test::random_vector(600, 4), x,
                                                {.tolerance = 1e-14, .max_iterations = 3});
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NE(report.reason.find("after 3 iterations"), std::string::npos) << report.reason;
}
TEST(ConjugateGradient, IsBitIdenticalForOneAndEightThreads) {
  const BlockMatrix A = test::ring_matrix(3000);
  const VecX b = test::random_vector(9000, 5);
  const auto solve = [&] {
    VecX x = VecX::Zero(9000);
    conjugate_gradient(A, b, x);
    return x;
  };
  EXPECT_EQ(with_threads(1, solve), with_threads(8, solve));
}
TEST(ConjugateGradient, RejectsWrongSizesAndOptions) {
  const BlockMatrix A = test::ring_matrix(10);
  VecX x = VecX::Zero(30);
  EXPECT_THROW(conjugate_gradient(A, VecX::Zero(29), x), Error);
  EXPECT_THROW(conjugate_gradient(A, VecX::Zero(30), x, {.tolerance = 0.0}), Error);
  EXPECT_THROW(conjugate_gradient(A, VecX::Zero(30), x, {.max_iterations = 0}), Error);
}

}  // namespace coxa::solve
