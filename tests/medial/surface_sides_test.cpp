#include <coxa/medial/surface_sides.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/remesh.h>
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

TEST(SurfaceSides, OfManyTrianglesAreThoseOfACoarserSurface) {
  const TriMesh fine = test::lunate_shell(25.0, 1.6, radians(230.0), radians(45.0), 300, 60);
  ASSERT_GT(fine.n_triangles(), 60000);
  const SurfaceSides sides = split_sides(fine);
  Index counts[2][2] = {};  // outer or inner face, first side or not
  for (Index t = 0; t < fine.n_triangles(); ++t) {
    double r = 0.0;
    for (int k = 0; k < 3; ++k) r += fine.points.row(fine.triangles(t, k)).norm() / 3.0;
    if (r > 25.01 && r < 26.59) continue;  // a wall
    ++counts[r > 26.0][sides.labels[static_cast<std::size_t>(t)] == SideLabel::first];
  }
  const Index agree = std::max(counts[0][0] + counts[1][1], counts[0][1] + counts[1][0]);
  EXPECT_GT(agree, 0.97 * fine.n_triangles());
  EXPECT_GT(sides.sheetness, 0.9);
}

TEST(SurfaceSides, FaceEachOtherByNoMoreThanTheBound) {
  for (const TriMesh& body : {test::lunate_shell(), test::torus(), test::icosphere(3, 5.0)}) {
    const FacingBound bound = facing_bound(body);
    const SurfaceSides sides = split_sides(body);
    EXPECT_LE(sides.sheetness, bound.sheetness + 1e-12);
    EXPECT_EQ(sides.relative_thickness, bound.relative_thickness);
  }
  EXPECT_LT(facing_bound(test::lunate_shell()).relative_thickness, 0.1);
  EXPECT_GT(facing_bound(test::icosphere(3, 5.0)).relative_thickness, 0.5);
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

TEST(SurfaceSides, OfAThickBodyOfManyTrianglesAreToldFromACoarserSurface) {
  // a long bar, twice as wide as thick
  TriMesh bar = test::icosphere(5, 10.0);
  bar.points.col(0) *= 6.0;
  bar.points.col(1) *= 2.0;
  ASSERT_GT(bar.n_triangles(), 10000);
  ASSERT_GT(facing_bound(bar).relative_thickness, 0.15);
  const TriMesh coarse = decimate(bar, {.n_triangles = 5000});
  EXPECT_NEAR(split_sides(bar).sheetness, split_sides(coarse).sheetness, 0.02);
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
