#include <coxa/medial/surface_sides.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa::medial {

TEST(SurfaceSides, OfAWalledShellAreItsInnerAndOuterFace) {
  const TriMesh shell = test::lunate_shell(25.0, 1.6);
  const SurfaceSides sides = split_sides(shell);
  SideLabel outer = SideLabel::rim, inner = SideLabel::rim;
  int wrong = 0;
  for (Index t = 0; t < shell.n_triangles(); ++t) {
    double low = kInfinity, high = 0.0;
    for (int k = 0; k < 3; ++k) {
      low = std::min(low, shell.points.row(shell.triangles(t, k)).norm());
      high = std::max(high, shell.points.row(shell.triangles(t, k)).norm());
    }
    const SideLabel label = sides.labels[static_cast<std::size_t>(t)];
    if (high - low > 1.0) {
      wrong += label != SideLabel::rim;  // a wall
    } else {
      SideLabel& face = low > 25.8 ? outer : inner;
      if (face == SideLabel::rim) face = label;
      wrong += label != face;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_NE(outer, inner);
  EXPECT_GT(sides.sheetness, 0.9);
}

TEST(SurfaceSides, GiveTheThicknessAlongTheInwardNormal) {
  const TriMesh shell = test::lunate_shell(25.0, 1.6);
  const SurfaceSides sides = split_sides(shell);
  Index near = 0;
  for (Index t = 0; t < shell.n_triangles(); ++t) near += std::abs(sides.thickness[t] - 1.6) < 0.02;
  EXPECT_GT(near, 0.9 * shell.n_triangles());
}

TEST(SurfaceSides, OfASphereAreNoSheet) {
  // rays meet the far side head on, but the two halves cannot disagree everywhere
  EXPECT_LT(split_sides(test::torus()).sheetness, 1.0);
}

TEST(SurfaceSides, AreBitIdenticalForOneAndEightThreads) {
  const TriMesh shell = test::lunate_shell();
  const auto run = [&] { return split_sides(shell); };
  const SurfaceSides one = with_threads(1, run), eight = with_threads(8, run);
  EXPECT_EQ(one.labels, eight.labels);
  EXPECT_EQ(one.sheetness, eight.sheetness);
}

TEST(SurfaceSides, OfAnOpenSurfaceAreRefused) {
  EXPECT_THROW(split_sides(test::plate(0.0)), Error);
}

}  // namespace coxa::medial
