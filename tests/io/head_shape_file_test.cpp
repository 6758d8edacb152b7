#include <coxa/io/head_shape_file.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "test_files.h"

namespace coxa::io {

TEST(HeadShapeFile, IsReadAsItWasWritten) {
  const TestFolder folder;
  motion::HeadShape shape{2, VecX::LinSpaced(5, -0.002, 0.003), VecX::Constant(1, 0.0021),
                          "two heads"};
  write_head_shape(folder / "head.toml", shape);
  const motion::HeadShape read = read_head_shape(folder / "head.toml");
  EXPECT_EQ(read.degree, 2);
  EXPECT_LE((read.mean - shape.mean).norm(), 1e-5);
  EXPECT_NEAR(read.spread[0], 0.0021, 1e-6);
  EXPECT_EQ(read.source, "two heads");
}
TEST(HeadShapeFile, MustHoldAsManyNumbersAsItsDegree) {
  const TestFolder folder;
  write_head_shape(folder / "head.toml",
                   {3, VecX::Zero(5), VecX::Constant(2, 0.002), "too few numbers"});
  EXPECT_THROW(read_head_shape(folder / "head.toml"), Error);
}

}  // namespace coxa::io
