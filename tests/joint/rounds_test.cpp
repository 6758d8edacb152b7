#include "../../src/joint/rounds.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <functional>

namespace coxa::joint {
namespace {

using Map = std::function<VecX(const VecX&)>;

VecX after(const Map& G, VecX x, int rounds) {
  Relaxation relaxation;
  for (int k = 0; k < rounds; ++k) x = relaxation.next(x, G(x));
  return x;
}
/// x <- slope x, whose fixed point is 0.
Map line(double slope) {
  return [slope](const VecX& x) { return VecX(slope * x); };
}
VecX one() { return VecX::Ones(1); }

}  // namespace

TEST(Relaxation, TakesTheFirstStepInFull) {
  EXPECT_NEAR(after(line(-0.9), one(), 1)[0], -0.9, 1e-15);
}
TEST(Relaxation, EndsAnAlternatingIterationOnALineInTheSecondStep) {
  for (const double slope : {-0.5, -1.0, -3.0})
    EXPECT_NEAR(after(line(slope), one(), 2)[0], 0.0, 1e-14);
}
TEST(Relaxation, NeverGoesFartherThanTheIterationItself) {
  // Aitken would double the step of a slow approach; half the way is left, as without
  EXPECT_NEAR(after(line(0.5), one(), 3)[0], 0.125, 1e-15);
}
TEST(Relaxation, NeverTakesLessThanATenthOfAStep) {
  // Aitken's share is 1/31
  const double first = -30.0, second = first + 0.1 * (900.0 - first);
  EXPECT_NEAR(after(line(-30.0), one(), 2)[0], second, 1e-12);
}
TEST(Relaxation, BringsAPlaneIterationToRestThatSwingsForEver) {
  MatX A(2, 2);
  A << -1.0, 0.2, 0.1, -0.7;  // largest eigenvalue -1.06
  const VecX b = VecX::Constant(2, 0.3), start = VecX::Constant(2, 5.0);
  const Map G = [&](const VecX& x) { return VecX(A * x + b); };
  const VecX fixed = (MatX::Identity(2, 2) - A).inverse() * b;
  VecX plain = start;
  for (int k = 0; k < 30; ++k) plain = G(plain);
  EXPECT_GT((plain - fixed).norm(), 4.0);
  EXPECT_LT((after(G, start, 30) - fixed).norm(), 1e-8);
}
TEST(Relaxation, StaysWhereNothingMoves) {
  EXPECT_EQ(after([](const VecX& x) { return x; }, one(), 4)[0], 1.0);
}

TEST(Progress, StallsInTheSeventhRoundWithoutAny) {
  Progress progress;
  EXPECT_FALSE(progress.stalled(1.0, 1.0));
  for (int round = 1; round <= 6; ++round) EXPECT_FALSE(progress.stalled(1.0, 1.0)) << round;
  EXPECT_TRUE(progress.stalled(1.0, 1.0));
}
TEST(Progress, IsMadeByForcesOrByGapsAlone) {
  Progress by_forces, by_gaps;
  double value = 1.0;
  for (int round = 0; round < 40; ++round, value *= 0.75) {
    EXPECT_FALSE(by_forces.stalled(value, 1.0));
    EXPECT_FALSE(by_gaps.stalled(1.0, value));
  }
}
TEST(Progress, CountsManySmallSteps) {
  // 5 % a round: five rounds make the fifth that counts
  Progress progress;
  double value = 1.0;
  for (int round = 0; round < 60; ++round, value *= 0.95)
    EXPECT_FALSE(progress.stalled(value, 1.0));
  // 2 % a round: after seven rounds less than a fifth
  Progress slow;
  value = 1.0;
  bool stalled = false;
  for (int round = 0; round < 8; ++round, value *= 0.98) stalled = slow.stalled(value, 1.0);
  EXPECT_TRUE(stalled);
}
TEST(Progress, GoesByTheLowestSoFar) {
  Progress progress;
  EXPECT_FALSE(progress.stalled(0.1, 1.0));
  bool stalled = false;
  // falls again and again, but never below where it was
  for (int round = 0; round < 7; ++round)
    stalled = progress.stalled(round % 2 == 0 ? 5.0 : 0.2, 1.0);
  EXPECT_TRUE(stalled);
}
TEST(Progress, ForgivesTheRiseOfTheResidualThatNewMultipliersBring) {
  Progress progress, unforgiving;
  bool stalled = false, stalled_without = false;
  progress.stalled(0.01, 1.0);
  unforgiving.stalled(0.01, 1.0);
  progress.multipliers_changed();
  double value = 1.0;
  for (int round = 0; round < 7; ++round, value *= 0.7) {
    stalled = stalled || progress.stalled(value, 1.0);
    stalled_without = stalled_without || unforgiving.stalled(value, 1.0);
  }
  EXPECT_FALSE(stalled);
  EXPECT_TRUE(stalled_without);
}
TEST(Progress, StallsOnFiguresThatAreNoNumbers) {
  Progress progress;
  bool stalled = false;
  for (int round = 0; round < 7; ++round) stalled = progress.stalled(kNaN, kNaN);
  EXPECT_TRUE(stalled);
}

}  // namespace coxa::joint
