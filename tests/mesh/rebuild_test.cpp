#include <coxa/mesh/rebuild.h>
#include <coxa/mesh/repair.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/validate.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <cmath>

namespace coxa {

TEST(Rebuild, JoinsOverlappingBodiesIntoOne) {
  // two balls of 5 mm, 6 mm apart: the lens counted twice is known
  const TriMesh two =
      test::together(test::icosphere(3, 5.0), test::icosphere(3, 5.0, Vec3(6, 0, 0)));
  EXPECT_THROW(repair(two), Error);
  const Rebuilt rebuilt = rebuild(two);
  EXPECT_TRUE(validate(rebuilt.mesh).valid());
  EXPECT_EQ(genus(rebuilt.mesh), 0);
  const double lens = kPi * (4 * 5.0 + 6.0) * (2 * 5.0 - 6.0) * (2 * 5.0 - 6.0) / 12.0;
  const double ball = volume(test::icosphere(3, 5.0));
  EXPECT_NEAR(volume(rebuilt.mesh), 2 * ball - lens, 0.02 * ball);
  EXPECT_LT(rebuilt.largest_move, 0.4);
}
TEST(Rebuild, ClosesHolesAndIgnoresTurnedTrianglesAndInnerWalls) {
  TriMesh mesh = test::together(test::icosphere(3, 5.0), test::plate(0.0, 3.0, 4));
  mesh.triangles.row(17).reverseInPlace();
  mesh.triangles.row(40) = mesh.triangles.row(41);
  const Rebuilt rebuilt = rebuild(mesh);
  EXPECT_EQ(genus(rebuilt.mesh), 0);
  EXPECT_NEAR(volume(rebuilt.mesh), volume(test::icosphere(3, 5.0)), 0.02 * 523.6);
}
TEST(Rebuild, FinerGridsComeNearer) {
  const auto error = [](double spacing) {
    return std::abs(volume(rebuild(test::box(Vec3(0, 0, 0), Vec3(6, 5, 4)),
                                   {.spacing = spacing, .target_edge = 0.5})
                               .mesh) -
                    120.0);
  };
  EXPECT_LT(error(0.25), error(1.0));
}
TEST(Rebuild, SmoothingRoundsEdgesAndLeavesWallsWhereTheyAre) {
  const TriMesh slab = test::box(Vec3(0, 0, 0), Vec3(8, 8, 1.2));
  const auto extent = [&](double smoothing) {
    const TriMesh mesh =
        rebuild(slab, {.spacing = 0.2, .smoothing = smoothing, .target_edge = 0.4}).mesh;
    double middle = -kInfinity, corner = -kInfinity;
    for (const auto& p : mesh.points.rowwise()) {
      if ((p.head<2>().transpose() - Eigen::Vector2d(4, 4)).norm() < 2.0)
        middle = std::max(middle, p[2]);
      corner = std::max(corner, p[0] + p[1] + p[2]);
    }
    return std::pair(middle, corner);
  };
  EXPECT_NEAR(extent(0.4).first, 1.2, 0.03);
  EXPECT_LT(extent(0.4).second, extent(0.0).second - 0.3);
}
TEST(Rebuild, ThickeningKeepsThinWallsAndTheLossIsTold) {
  // a fin of a twentieth of a millimetre on a block
  const TriMesh mesh = test::together(test::box(Vec3(0, 0, 0), Vec3(4, 4, 4)),
                                      test::box(Vec3(3.9, 1.5, 1.51), Vec3(7, 2.5, 1.56)));
  const Rebuilt thin = rebuild(mesh, {.spacing = 0.3}),
                thick = rebuild(mesh, {.spacing = 0.2, .thickening = 0.15, .target_edge = 0.4});
  EXPECT_NEAR(thin.largest_loss, 3.0, 0.5);
  EXPECT_EQ(thin.thickened_area, 0.0);
  EXPECT_LT(thick.largest_loss, 0.3);  // at the edges of the block
  EXPECT_NEAR(thick.mesh.points.col(0).maxCoeff(), 7.15, 0.15);
  // the block stays where it was, but for its edges, which a grid cuts off
  EXPECT_NEAR(thick.mesh.points.col(0).minCoeff(), 0.0, 0.02);
  EXPECT_LT(thick.largest_move, 0.25);
  const double fin = 2 * (3.0 * 1.0 + 3.0 * 0.05 + 0.5 * 1.0 * 0.05);
  EXPECT_GT(thick.thickened_area, fin - 1.0);
  EXPECT_LT(thick.thickened_area, fin + 1.0);
}
TEST(Rebuild, ThinWallsGetFewTrianglesThatDoNotCutEachOther) {
  // wings thinner than the edge length asked for: even triangles of their two sides would meet
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(3, 3, 3));
  for (int k = 0; k < 6; ++k)
    mesh = test::together(mesh,
                          test::box(Vec3(2.9, 0.3 + 0.4 * k, 0.2), Vec3(8, 0.31 + 0.4 * k, 2.7)));
  const Rebuilt rebuilt = rebuild(mesh, {.spacing = 0.2, .thickening = 0.12, .target_edge = 0.9});
  EXPECT_TRUE(validate(rebuilt.mesh).valid());
  const double of_triangle = triangle_areas(rebuilt.mesh).sum() / rebuilt.mesh.n_triangles();
  EXPECT_GT(of_triangle, 0.25 * 0.25 * std::sqrt(3.0) * 0.9 * 0.9);
}
TEST(Rebuild, LeavesOutNoMoreThanAllowed) {
  const TriMesh mesh = test::together(test::box(Vec3(0, 0, 0), Vec3(4, 4, 4)),
                                      test::box(Vec3(3.9, 1.5, 1.51), Vec3(7, 2.5, 1.56)));
  EXPECT_THROW(rebuild(mesh, {.spacing = 0.3, .max_loss = 1.0}), Error);
  EXPECT_NO_THROW(rebuild(mesh, {.spacing = 0.3, .max_loss = 4.0}));
}
TEST(Rebuild, EdgeLengthIsAsAsked) {
  EXPECT_NEAR(mean_edge_length(rebuild(test::icosphere(3, 5.0), {.target_edge = 1.5}).mesh), 1.5,
              0.15);
}
TEST(Rebuild, RefusesSheetsAndLargeMoves) {
  EXPECT_THROW(rebuild(test::plate(0.0)), Error);
  // a bowl without its lid: the lid would be far from the old surface
  TriMesh bowl = test::icosphere(3, 5.0);
  std::vector<Index> kept;
  for (Index t = 0; t < bowl.n_triangles(); ++t)
    if (bowl.points(bowl.triangles(t, 0), 2) < 1.0) kept.push_back(t);
  bowl = sub_mesh(bowl, kept).mesh;
  EXPECT_THROW(rebuild(bowl), Error);
  EXPECT_THROW(rebuild(test::box(), {.spacing = 0.0}), Error);
  EXPECT_THROW(rebuild(test::box(), {.spacing = 1e-4}), Error);
  EXPECT_THROW(rebuild(test::box(), {.target_edge = 0.0}), Error);
  EXPECT_THROW(rebuild(test::box(), {.smoothing = -1.0}), Error);
  EXPECT_THROW(rebuild(test::box(), {.thickening = -1.0}), Error);
  EXPECT_THROW(rebuild(test::box(), {.max_move = -1.0}), Error);
  EXPECT_THROW(rebuild(test::box(), {.max_loss = -1.0}), Error);
}
TEST(Rebuild, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] { return rebuild(test::torus(5.0, 1.5, 24, 12)).mesh.points; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

}  // namespace coxa
