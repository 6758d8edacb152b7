#include <coxa/core/rng.h>

#include <gtest/gtest.h>

namespace coxa {

TEST(Rng, RepeatsItsSequenceForTheSameSeed) {
  Rng a(42), b(42);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.bits(), b.bits());
}
TEST(Rng, DiffersForAnotherSeed) { EXPECT_NE(Rng(1).bits(), Rng(2).bits()); }
TEST(Rng, NormalHasMeanZeroAndVarianceOne) {
  Rng rng(7);
  const int n = 200000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < n; ++i) {
    const double x = rng.normal();
    sum += x;
    squares += x * x;
  }
  // five standard errors of the mean and of the variance
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, 5.0 * std::sqrt(2.0 / n));
}
TEST(Rng, BelowStaysInRange) {
  Rng rng(3);
  for (int i = 0; i < 1000; ++i) {
    const Index k = rng.below(7);
    ASSERT_TRUE(0 <= k && k < 7);
  }
}

}  // namespace coxa
