#include <coxa/core/error.h>

#include <gtest/gtest.h>

namespace coxa {

TEST(Error, CarriesItsCodeAndText) {
  try {
    require(1 > 2, "limit is ", 2, " mm, got ", 1.5);
    FAIL() << "require did not throw";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_STREQ(error.what(), "limit is 2 mm, got 1.5");
  }
}
TEST(Error, MapsEachCodeToTheExitCodeOfTheCommandLine) {
  EXPECT_EQ(exit_code(ErrorCode::usage), 2);
  EXPECT_EQ(exit_code(ErrorCode::bad_input), 3);
  EXPECT_EQ(exit_code(ErrorCode::bad_file), 3);
  EXPECT_EQ(exit_code(ErrorCode::bad_mesh), 3);
  EXPECT_EQ(exit_code(ErrorCode::no_convergence), 4);
  EXPECT_EQ(exit_code(ErrorCode::below_quality), 5);
  EXPECT_EQ(exit_code(ErrorCode::cancelled), 130);
}
TEST(ErrorDeathTest, AssertionNamesTheExpression) { EXPECT_DEATH(COXA_ASSERT(1 == 2), "1 == 2"); }

}  // namespace coxa
