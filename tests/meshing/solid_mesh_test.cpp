#include <coxa/meshing/mesh_surface.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/surface_distance.h>
#include <gtest/gtest.h>
#include "grids.h"
#include "support/shapes.h"

#include <cmath>

namespace coxa::meshing {
namespace {

TriMesh bumpy_ball() {
  TriMesh mesh = coxa::test::icosphere(4, 15.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v), n = p.normalized();
    mesh.points.row(v) += (1.5 * std::sin(5.0 * n[0]) * std::cos(4.0 * n[1]) * n).transpose();
  }
  return mesh;
}

void expect_good(const TriMesh& body, double envelope) {
  const MeshingResult made = mesh_surface(body, {.max_tets = 30000});
  const TetMesh& mesh = made.mesh;
  EXPECT_EQ(made.report.method, Method::lattice);
  EXPECT_LE(mesh.n_tets(), 30000);
  EXPECT_GT(tet_volumes(mesh.points, mesh.tets).minCoeff(), 0.0);
  const TriMesh skin = test::envelope(mesh);
  EXPECT_EQ(manifold_fault(skin), "");
  EXPECT_EQ(genus(skin), genus(body));
  EXPECT_NEAR(made.report.quality.volume / volume(body), 1.0, 0.02);
  EXPECT_LE(surface_distance(skin, body).hd, envelope);
  EXPECT_GE(made.report.quality.aspect_mean, 0.72);
  EXPECT_GE(made.report.quality.aspect_p05, 0.5);
  EXPECT_GE(made.report.quality.aspect_min, 0.15);
  EXPECT_GE(degrees(made.report.quality.dihedral_min), 10.0);
  EXPECT_LE(degrees(made.report.quality.dihedral_max), 165.0);
}

TEST(SolidMesh, FillsABall) { expect_good(coxa::test::icosphere(3, 10.0), 0.3); }
TEST(SolidMesh, FillsARing) { expect_good(coxa::test::torus(20.0, 4.0, 96, 48), 0.3); }
TEST(SolidMesh, FillsABodyWithDents) { expect_good(bumpy_ball(), 0.3); }
TEST(SolidMesh, FillsABox) {
  expect_good(coxa::test::box(Vec3(-10, -6, -5), Vec3(10, 6, 5)), 1e-3);
}

TEST(SolidMesh, OpensAGapNarrowerThanItsCubes) {
  // a ring, open by 0.45 mm, with faces of 2 by 2 mm on both sides
  const double radius = 5.0, gap = 0.45;
  const TriMesh ring =
      coxa::test::lunate_shell(radius, 2.0, 2.0 * kPi - gap / radius, radians(20.0), 64, 2);
  const MeshingResult made = mesh_surface(ring, {.method = Method::lattice});
  EXPECT_LE(made.report.envelope, 0.25);
  EXPECT_EQ(genus(test::envelope(made.mesh)), 0);
  EXPECT_TRUE(meets_limits(made.report));
}

TEST(SolidMesh, SaysWhyALatticeWasTaken) {
  const MeshingResult made = mesh_surface(coxa::test::icosphere(3, 10.0), {.max_tets = 5000});
  ASSERT_FALSE(made.report.notes.empty());
  EXPECT_NE(made.report.notes[0].find("no sheet"), std::string::npos);
  EXPECT_THROW(mesh_surface(coxa::test::icosphere(3, 10.0), {.method = Method::medial}), Error);
}

TEST(SolidMesh, IsTheSameForOneAndEightThreads) {
  const auto run = [] { return mesh_surface(bumpy_ball(), {.max_tets = 8000}).mesh; };
  const TetMesh one = with_threads(1, run), eight = with_threads(8, run);
  EXPECT_EQ(one.points, eight.points);
  EXPECT_EQ(one.tets, eight.tets);
}

TEST(SolidMesh, FollowsTheSizeOfTheBody) {
  // the same body a hundred times smaller gets the same elements
  TriMesh small = bumpy_ball();
  small.points *= 0.01;
  const MeshingResult made = mesh_surface(small);
  EXPECT_GT(made.mesh.n_tets(), 2000);
  EXPECT_GE(made.report.quality.aspect_min, 0.15);
}

}  // namespace
}  // namespace coxa::meshing
