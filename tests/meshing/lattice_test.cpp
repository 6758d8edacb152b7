#include "meshing/lattice.h"

#include <coxa/mesh/measures.h>
#include <coxa/mesh/tet_quality.h>
#include <gtest/gtest.h>
#include "grids.h"
#include "support/shapes.h"

#include <cmath>

namespace coxa::meshing {
namespace {

TetGrid stuffed_with(const TriMesh& surface, const OctreeOptions& options) {
  const TriangleTree tree(surface.points, surface.triangles);
  return stuffed(make_lattice(Octree(surface, options)), tree);
}

TEST(Lattice, FillsItsCubeBetweenCentresWithoutGapOrOverlap) {
  const Octree octree(coxa::test::box(Vec3(-4, -4, -1), Vec3(4, 4, 1)),
                      {.flatness = 0.1, .smallest = 0.3, .largest = 4.0});
  const Lattice lattice = make_lattice(octree);
  const TetGrid grid = test::make_grid(lattice.points, lattice.tets);
  EXPECT_GT(test::least_volume(grid), 0.0);
  EXPECT_EQ(test::boundary_fault(grid), "");
  // positive elements whose sum is the volume within their common boundary cannot overlap
  const TriMesh outside = test::envelope(to_tet_mesh(grid));
  EXPECT_NEAR(test::volume_of(grid), volume(outside), 1e-9 * volume(outside));
}

TEST(Lattice, HasTheAnglesOfItsFewKindsOfElements) {
  const Octree octree(coxa::test::box(Vec3(-4, -4, -1), Vec3(4, 4, 1)),
                      {.flatness = 0.1, .smallest = 0.3, .largest = 4.0});
  const Lattice lattice = make_lattice(octree);
  const TetMesh mesh = to_tet_mesh(test::make_grid(lattice.points, lattice.tets));
  const TetQuality quality = tet_quality(mesh.points, mesh.tets);
  EXPECT_NEAR(degrees(quality.dihedral_min), 45.0, 1e-6);
  EXPECT_NEAR(degrees(quality.dihedral_max), 120.0, 1e-6);
}

TEST(Stuffing, KeepsVolumeAndTopologyOfSmoothBodies) {
  for (const TriMesh& body :
       {coxa::test::icosphere(4, 10.0), coxa::test::torus(10.0, 3.0, 96, 48)}) {
    const TetGrid grid = stuffed_with(body, {.flatness = 0.15, .smallest = 0.5, .largest = 3.0});
    EXPECT_GT(test::least_volume(grid), 0.0);
    EXPECT_EQ(test::boundary_fault(grid), "");
    EXPECT_EQ(genus(test::envelope(to_tet_mesh(grid))), genus(body));
    // chords of the cubes' size lose this share of a body bent everywhere
    EXPECT_NEAR(test::volume_of(grid) / volume(body), 1.0, 0.03);
  }
}

TEST(Stuffing, GivesManifoldBoundariesWhateverTheBody) {
  // balls that nearly touch, overlap as seen by the lattice, or are thinner than its cubes
  for (const double gap : {0.05, 0.2, 0.5, 1.0}) {
    const TriMesh two =
        coxa::test::together(coxa::test::icosphere(2, 4.0, Vec3(-4.0 - 0.5 * gap, 0.1, 0.2)),
                             coxa::test::icosphere(2, 4.0, Vec3(4.0 + 0.5 * gap, 0, 0)));
    const TetGrid grid = stuffed_with(two, {.flatness = 0.6, .smallest = 1.2, .largest = 3.0});
    EXPECT_EQ(test::boundary_fault(grid), "") << gap;
  }
  for (const double thickness : {0.1, 0.4, 0.8, 1.6}) {
    const TriMesh shell = coxa::test::lunate_shell(20.0, thickness);
    const TetGrid grid = stuffed_with(shell, {.flatness = 0.5, .smallest = 1.0, .largest = 3.0});
    if (grid.tets.empty()) continue;
    EXPECT_EQ(test::boundary_fault(grid), "") << thickness;
  }
}

TEST(PinchedNodes, AreThoseWhereElementsMeetInAPointOrAnEdge) {
  const std::vector<Vec3> x{{0, 0, 0},  {1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                            {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, -1, 0}};
  EXPECT_TRUE(pinched_nodes(test::make_grid(x, {{0, 1, 2, 3}})).empty());
  EXPECT_EQ(pinched_nodes(test::make_grid(x, {{0, 1, 2, 3}, {0, 5, 4, 6}})), std::vector<Index>{0});
  EXPECT_EQ(pinched_nodes(test::make_grid(x, {{0, 1, 2, 3}, {0, 4, 5, 3}})),
            (std::vector<Index>{0, 3}));
}

}  // namespace
}  // namespace coxa::meshing
