#include <coxa/mesh/tet_quality.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <cmath>

namespace coxa {

const Tets one = (Tets(1, 4) << 0, 1, 2, 3).finished();

Points regular() { return (Points(4, 3) << 1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1).finished(); }

// unit cube in six tetrahedra around its diagonal
struct Cube {
  Points points{8, 3};
  Tets tets{6, 4};
  Cube() {
    for (int i = 0; i < 8; ++i) points.row(i) << (i & 1), ((i >> 1) & 1), (i >> 2);
    tets << 0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7;
  }
};

TEST(TetQuality, OfTheRegularTetrahedronIsPerfect) {
  const TetQuality q = tet_quality(regular(), one);
  EXPECT_EQ(q.n_inverted, 0);
  EXPECT_NEAR(q.aspect_mean, 1.0, 1e-14);
  EXPECT_NEAR(q.dihedral_min, std::acos(1.0 / 3.0), 1e-14);
  EXPECT_NEAR(q.dihedral_max, std::acos(1.0 / 3.0), 1e-14);
  EXPECT_NEAR(q.volume, 8.0 / 3.0, 1e-14);
}
TEST(TetQuality, OfTheKuhnCubeIsThePublishedFigure) {
  // mean aspect 0.717, mean dihedral angle 70 degrees: tables for cubes cut in six
  const Cube cube;
  const TetQuality q = tet_quality(cube.points, cube.tets);
  EXPECT_NEAR(q.volume, 1.0, 1e-14);
  EXPECT_NEAR(q.aspect_mean, 0.717, 5e-4);
  EXPECT_NEAR(degrees(q.dihedral_mean), 70.0, 1e-10);
  EXPECT_NEAR(degrees(q.dihedral_min), 45.0, 1e-10);
  EXPECT_NEAR(degrees(q.dihedral_max), 90.0, 1e-10);
}
TEST(TetQuality, CountsInvertedTetrahedraAndGivesThemNoAspect) {
  Points points = regular();
  points.row(0).swap(points.row(1));
  EXPECT_EQ(tet_quality(points, one).n_inverted, 1);
  EXPECT_EQ(tet_aspects(points, one)[0], 0.0);
  EXPECT_LT(tet_volumes(points, one)[0], 0.0);
}
TEST(TetQuality, IsUnchangedBySimilarities) {
  const Points points = test::random_points(4, 1.0, 5);
  const Points moved = transformed(3.0 * points, test::some_pose());
  EXPECT_NEAR(tet_aspects(points, one)[0], tet_aspects(moved, one)[0], 1e-12);
  EXPECT_LE((tet_dihedrals(points, one) - tet_dihedrals(moved, one)).cwiseAbs().maxCoeff(), 1e-12);
}
TEST(TetDihedrals, NameTheEdgesInOrder) {
  // corner tetrahedron: right angles at the three edges that meet in vertex 0
  const Points corner = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1).finished();
  const TetDihedrals angles = tet_dihedrals(corner, one);
  for (int edge = 0; edge < 3; ++edge) EXPECT_NEAR(angles(0, edge), kPi / 2, 1e-14);
  for (int edge = 3; edge < 6; ++edge)
    EXPECT_NEAR(angles(0, edge), std::acos(1.0 / std::sqrt(3.0)), 1e-14);
  // a flat tetrahedron tells edge 01 from edge 23: nearly closed at one, open at the other
  const Points flat = (Points(4, 3) << -5, 0, 0, 5, 0, 0, 0, -1, 1, 0, 1, 1).finished();
  EXPECT_NEAR(tet_dihedrals(flat, one)(0, 0), 2 * std::atan(1.0), 1e-12);
  EXPECT_NEAR(tet_dihedrals(flat, one)(0, 5), 2 * std::atan(5.0), 1e-12);
}
TEST(BoundaryFacets, OfACubeAreItsOutwardSurface) {
  const Cube cube;
  std::vector<Index> owners;
  const TriMesh surface{cube.points, boundary_facets(cube.tets, &owners)};
  EXPECT_EQ(surface.n_triangles(), 12);
  EXPECT_EQ(manifold_fault(surface), "");
  EXPECT_NEAR(volume(surface), 1.0, 1e-14);
  ASSERT_EQ(owners.size(), 12u);
  for (Index f = 0; f < 12; ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_TRUE(
          (cube.tets.row(owners[static_cast<std::size_t>(f)]).array() == surface.triangles(f, k))
              .any());
}
TEST(TetQuality, IsBitIdenticalForOneAndEightThreads) {
  const Cube cube;
  const auto run = [&] { return tet_dihedrals(cube.points, cube.tets); };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(TetQuality, RejectsEmptyMeshesAndBadIndices) {
  EXPECT_THROW(tet_quality(regular(), Tets(0, 4)), Error);
  EXPECT_THROW(tet_quality(regular().topRows(3), one), Error);
}
TEST(Percentile, InterpolatesBetweenNeighbours) {
  const VecX values = (VecX(5) << 4, 1, 3, 2, 5).finished();
  EXPECT_EQ(percentile(values, 0.0), 1.0);
  EXPECT_EQ(percentile(values, 1.0), 5.0);
  EXPECT_NEAR(percentile(values, 0.6), 3.4, 1e-14);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
  EXPECT_THROW(percentile(values, 1.5), Error);
}

}  // namespace coxa
