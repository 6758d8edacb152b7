#include <coxa/core/parallel.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace coxa {

double harmonic_sum() {
  return parallel_reduce(
      100001, 0.0, [](Index i) { return 1.0 / (1.0 + i); },
      [](double a, double b) { return a + b; });
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
  std::vector<int> visits(10007, 0);
  with_threads(
      8, [&] { parallel_for(10007, [&](Index i) { ++visits[static_cast<std::size_t>(i)]; }); });
  for (int count : visits) ASSERT_EQ(count, 1);
}
TEST(ParallelFor, DoesNothingForNoIterations) {
  parallel_for(0, [](Index) { FAIL(); });
}
TEST(ParallelReduce, EqualsTheSerialSumToRounding) {
  double serial = 0.0;
  for (int i = 0; i < 100001; ++i) serial += 1.0 / (1.0 + i);
  EXPECT_NEAR(harmonic_sum(), serial, 1e-10);
}
TEST(ParallelReduce, IsBitIdenticalForOneAndEightThreads) {
  EXPECT_EQ(with_threads(1, harmonic_sum), with_threads(8, harmonic_sum));
}
TEST(ThreadCount, IsRestoredAfterwardsAndRejectsZero) {
  const int before = thread_count();
  with_threads(3, [] { EXPECT_EQ(thread_count(), 3); });
  EXPECT_EQ(thread_count(), before);
  EXPECT_THROW(set_thread_count(0), Error);
}

}  // namespace coxa
