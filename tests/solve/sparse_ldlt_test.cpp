#include <coxa/solve/sparse_ldlt.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "solve/systems.h"

namespace coxa::solve {

TEST(SparseLdlt, SolvesToRounding) {
  const BlockMatrix A = test::ring_matrix(200);
  const VecX b = test::random_vector(600, 3);
  SparseLdlt solver;
  EXPECT_TRUE(solver.factorize(A).converged);
  EXPECT_EQ(solver.negative_pivots(), 0);
  VecX Ax;
  A.multiply(solver.solve(b), Ax);
  EXPECT_LE((Ax - b).norm(), 1e-11 * b.norm());
}
TEST(SparseLdlt, FollowsNewValuesAndANewPattern) {
  SparseLdlt solver;
  BlockMatrix A = test::ring_matrix(20);
  solver.factorize(A);
  A.at(2, 2) += 3.0 * Mat3::Identity();
  solver.factorize(A);
  VecX Ax;
  const VecX b = test::random_vector(60, 3);
  A.multiply(solver.solve(b), Ax);
  EXPECT_LE((Ax - b).norm(), 1e-11);
  const BlockMatrix larger = test::ring_matrix(30);
  solver.factorize(larger);
  const VecX c = test::random_vector(90, 3);
  larger.multiply(solver.solve(c), Ax);
  EXPECT_LE((Ax - c).norm(), 1e-11);
}
TEST(SparseLdlt, CountsTheNegativeEigenvaluesAndStillSolves) {
  BlockMatrix A = test::ring_matrix(20);
  A.at(4, 4)(1, 1) -= 1e4;
  SparseLdlt solver;
  EXPECT_TRUE(solver.factorize(A).converged);
  EXPECT_EQ(solver.negative_pivots(), 1);
}
TEST(SparseLdlt, SaysWhenAPivotIsZero) {
  SparseLdlt solver;
  const SolveReport report = solver.factorize(BlockMatrix(2, {}));
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.reason, "a pivot of the matrix is zero or not finite");
}
TEST(SparseLdlt, RejectsAVectorOfTheWrongLength) {
  SparseLdlt solver;
  solver.factorize(test::ring_matrix(10));
  EXPECT_THROW(solver.solve(VecX::Zero(7)), Error);
}

}  // namespace coxa::solve
