#include <coxa/solve/block_matrix.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "solve/systems.h"

namespace coxa::solve {

TEST(BlockMatrix, HoldsEachPairOnceInAscendingColumnsWithTheDiagonal) {
  const BlockMatrix A(3, {{0, 2}, {0, 2}, {0, 1}, {2, 0}, {1, 1}});
  EXPECT_EQ(A.n(), 3);
  EXPECT_EQ(A.row_start(), (std::vector<std::int64_t>{0, 3, 4, 6}));
  EXPECT_EQ(A.columns(), (std::vector<Index>{0, 1, 2, 1, 0, 2}));
  EXPECT_EQ(A.slot(2, 0), 4);
}
TEST(BlockMatrix, StartsAtZeroAndReturnsThere) {
  BlockMatrix A(2, {{0, 1}});
  for (const Mat3& block : A.blocks()) EXPECT_EQ(block, Mat3::Zero());
  A.at(0, 1).setOnes();
  A.set_zero();
  for (const Mat3& block : A.blocks()) EXPECT_EQ(block, Mat3::Zero());
}
TEST(BlockMatrix, MultipliesAsTheDenseMatrixDoes) {
  BlockMatrix A = test::ring_matrix(31);
  A.at(3, 4)(0, 2) += 5.0;  // not symmetric: rows and columns must not be confused
  const VecX x = test::random_vector(93, 2);
  VecX y;
  A.multiply(x, y);
  EXPECT_LE((y - test::dense(A) * x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((A.row_times(3, x.data()) - (test::dense(A) * x).segment<3>(9)).norm(), 1e-12);
}
TEST(BlockMatrix, MultipliesBitIdenticallyForOneAndEightThreads) {
  const BlockMatrix A = test::ring_matrix(2000);
  const VecX x = test::random_vector(6000, 3);
  const auto product = [&] {
    VecX y;
    A.multiply(x, y);
    return y;
  };
  EXPECT_EQ(with_threads(1, product), with_threads(8, product));
}
TEST(BlockMatrix, MayBeEmpty) {
  const BlockMatrix A(0, {});
  VecX y;
  A.multiply(VecX(), y);
  EXPECT_EQ(A.n(), 0);
  EXPECT_EQ(y.size(), 0);
}
TEST(BlockMatrix, RejectsABlockOutsideAndAVectorOfTheWrongLength) {
  try {
    BlockMatrix(2, {{0, 2}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "block (0, 2) lies outside a matrix of 2 rows");
  }
  VecX y;
  EXPECT_THROW(BlockMatrix(2, {}).multiply(VecX::Zero(5), y), Error);
}

}  // namespace coxa::solve
