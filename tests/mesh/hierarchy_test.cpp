#include <coxa/mesh/hierarchy.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/remesh.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TEST(FaceTriangulation, IsAClosedSurfaceOfTheSimplexVertices) {
  const SimplexMesh mesh = make_simplex_mesh(test::torus());
  const TriMesh surface = face_triangulation(mesh);
  EXPECT_EQ(surface.points, mesh.points);
  EXPECT_EQ(genus(surface), 1);
  EXPECT_GT(volume(surface), 0.0);
}
TEST(Hierarchy, HasTheLevelsAskedForWithTheRatioAskedFor) {
  const SimplexHierarchy hierarchy =
      make_hierarchy(test::icosphere(4), {.n_levels = 3, .ratio = 3.0});
  ASSERT_EQ(hierarchy.levels.size(), 3u);
  ASSERT_EQ(hierarchy.maps.size(), 2u);
  EXPECT_EQ(hierarchy.levels[2].n_vertices(), 5120);
  EXPECT_NEAR(hierarchy.levels[1].n_vertices(), 5120 / 3, 2);
  EXPECT_NEAR(hierarchy.levels[0].n_vertices(), 5120 / 9, 2);
}
TEST(Hierarchy, StopsAtTheSmallestLevel) {
  const SimplexHierarchy hierarchy =
      make_hierarchy(test::icosphere(3), {.n_levels = 6, .min_triangles = 100});
  EXPECT_GE(hierarchy.levels.front().n_vertices(), 100);
  EXPECT_EQ(hierarchy.levels.size(), 3u);  // 1280, 320, 100
}
TEST(Hierarchy, MapsCarryAffineFieldsAlong) {
  // weights that sum to 1 reproduce what is affine up to the distance between the two levels'
  // surfaces
  for (const TriMesh& mesh : {test::icosphere(4), test::lunate_shell(), test::torus()}) {
    const SimplexHierarchy hierarchy = make_hierarchy(mesh);
    for (std::size_t l = 0; l < hierarchy.maps.size(); ++l) {
      const LevelMap& map = hierarchy.maps[l];
      EXPECT_LE((map.weights.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-12);
      EXPECT_GE(map.weights.minCoeff(), 0.0);
      const Points carried = interpolate(map, hierarchy.levels[l].points);
      const double edge = edge_length_for(mesh, hierarchy.levels[l].n_vertices());
      EXPECT_LE((carried - hierarchy.levels[l + 1].points).rowwise().norm().mean(), 0.2 * edge);
    }
  }
}
TEST(Hierarchy, ThinShellsFollowTheirOwnSide) {
  const SimplexHierarchy hierarchy = make_hierarchy(test::lunate_shell());
  for (std::size_t l = 0; l < hierarchy.maps.size(); ++l) {
    const Points fine = simplex_normals(hierarchy.levels[l + 1]);
    const Points carried = interpolate(hierarchy.maps[l], simplex_normals(hierarchy.levels[l]));
    Index against = 0;
    for (Index v = 0; v < fine.rows(); ++v) against += fine.row(v).dot(carried.row(v)) < -0.3;
    EXPECT_LE(against,
              0.06 * fine.rows());  // a few at the rim, where normals turn within one triangle
  }
}
TEST(RestrictMean, OfAConstantIsTheConstantWhereFollowed) {
  const SimplexHierarchy hierarchy = make_hierarchy(test::icosphere(3));
  const Index n_fine = hierarchy.levels[1].n_vertices(),
              n_coarse = hierarchy.levels[0].n_vertices();
  const Points mean = restrict_mean(hierarchy.maps[0], Points::Ones(n_fine, 3), n_coarse);
  for (Index c = 0; c < n_coarse; ++c)
    EXPECT_TRUE(mean.row(c).isZero() || (mean.row(c).array() - 1.0).abs().maxCoeff() < 1e-12);
  EXPECT_GT(mean.col(0).sum(), 0.95 * n_coarse);
  EXPECT_THROW(restrict_mean(hierarchy.maps[0], Points::Ones(3, 3), n_coarse), Error);
}
TEST(Hierarchy, IsBitIdenticalForOneAndEightThreads) {
  const auto weights = [] { return make_hierarchy(test::lunate_shell()).maps.back().weights; };
  EXPECT_EQ(with_threads(1, weights), with_threads(8, weights));
}
TEST(Hierarchy, RejectsBadOptionsAndOpenSurfaces) {
  EXPECT_THROW(make_hierarchy(test::plate(0.0)), Error);
  EXPECT_THROW(make_hierarchy(test::box(), {.n_levels = 0}), Error);
  EXPECT_THROW(make_hierarchy(test::box(), {.ratio = 1.0}), Error);
  EXPECT_THROW(make_hierarchy(test::box(), {.min_triangles = 4}), Error);
}

}  // namespace coxa
