#include <coxa/mesh/validate.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

// the kinds found, alone
std::vector<FaultKind> kinds(const TriMesh& mesh) {
  std::vector<FaultKind> found;
  for (const Fault& fault : validate(mesh).faults) found.push_back(fault.kind);
  return found;
}
using Kinds = std::vector<FaultKind>;

TEST(Validate, FindsNoFaultInGoodSurfaces) {
  for (const TriMesh& mesh :
       {test::box(), test::torus(), test::icosphere(3), test::lunate_shell()}) {
    const ValidityReport report = validate(mesh);
    EXPECT_TRUE(report.valid());
    EXPECT_EQ(report.text(), "no fault");
  }
}
TEST(Validate, NamesEveryKindOfFaultAlone) {
  TriMesh mesh = test::box();
  mesh.triangles(5, 2) = 9;
  EXPECT_EQ(kinds(mesh), Kinds{FaultKind::bad_index});
  mesh = test::box();
  mesh.points(3, 1) = kNaN;
  EXPECT_EQ(kinds(mesh), Kinds{FaultKind::not_finite});
  mesh = test::box();
  mesh.points.conservativeResize(9, 3);
  mesh.points.row(8) << 9, 9, 9;
  EXPECT_EQ(kinds(mesh), Kinds{FaultKind::unused_vertex});
  mesh = test::box();
  mesh.triangles.conservativeResize(11, 3);
  EXPECT_EQ(kinds(mesh), Kinds{FaultKind::open_boundary});
  mesh = test::box();
  mesh.triangles.row(7).reverseInPlace();
  EXPECT_EQ(kinds(mesh), Kinds{FaultKind::mixed_orientation});
  EXPECT_EQ(kinds(test::turned_over(test::torus())), Kinds{FaultKind::inward_orientation});
  EXPECT_EQ(
      kinds(test::together(test::icosphere(2),
                           test::moved(test::icosphere(2), {Mat3::Identity(), Vec3(7, 0, 0)}))),
      Kinds{FaultKind::self_intersection});
}
TEST(Validate, CountsPlacesAndTellsWhereTheFirstIs) {
  TriMesh mesh = test::plate(2.0, 1.0, 2);
  const Fault border = validate(mesh).faults.front();
  EXPECT_EQ(border.kind, FaultKind::open_boundary);
  EXPECT_EQ(border.count, 8);
  EXPECT_EQ(border.place[2], 2.0);
  EXPECT_NE(describe(border).find("open boundary (8 places, first at ("), std::string::npos);
}
TEST(Validate, FindsDuplicatesFlatTrianglesAndFins) {
  TriMesh mesh = test::box();
  mesh.triangles.conservativeResize(13, 3);
  mesh.triangles.row(12) = mesh.triangles.row(3);
  EXPECT_TRUE(validate(mesh).has(FaultKind::duplicate_triangle));
  EXPECT_TRUE(validate(mesh).has(FaultKind::non_manifold_edge));
  mesh = test::box();
  mesh.points.row(7) = mesh.points.row(6);
  EXPECT_TRUE(validate(mesh).has(FaultKind::duplicate_point));
  EXPECT_TRUE(validate(mesh).has(FaultKind::degenerate_triangle));
}
TEST(Validate, SeesSheetsThatTouchInAVertex) {
  TriMesh mesh = test::together(test::box(), test::box(Vec3(1, 1, 1), Vec3(2, 2, 2)));
  mesh.triangles = mesh.triangles.unaryExpr([](Index v) { return v == 8 ? 7 : v; }).eval();
  EXPECT_TRUE(validate(mesh).has(FaultKind::non_manifold_vertex));
}
TEST(Validate, SliversAreWarningsAboveTheRatioAskedFor) {
  const TriMesh thin = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1e-4));
  EXPECT_EQ(kinds(thin), Kinds{FaultKind::sliver});
  EXPECT_TRUE(validate(thin).valid());
  EXPECT_TRUE(validate(thin, {.sliver_ratio = 1e-5}).faults.empty());
  EXPECT_THROW(validate(thin, {.sliver_ratio = 1.0}), Error);
}
TEST(Validate, CavitiesAreInwardOnPurpose) {
  EXPECT_TRUE(
      validate(test::together(test::icosphere(2, 10.0), test::turned_over(test::icosphere(2, 5.0))))
          .valid());
  EXPECT_TRUE(validate(test::together(test::icosphere(2, 10.0), test::icosphere(2, 5.0)))
                  .has(FaultKind::inward_orientation));
}
TEST(SelfIntersections, FindFoldsAndNeighboursThatCross) {
  // a vertex of a sphere pushed through the other side
  TriMesh mesh = test::icosphere(2);
  EXPECT_TRUE(self_intersections(mesh).empty());
  mesh.points.row(3) *= -1.05;
  EXPECT_GT(self_intersections(mesh).size(), 5u);
  // two triangles over one edge, folded onto each other
  TriMesh fold;
  fold.points = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 0.2, 1, 0, 0.6, 0.8, 0).finished();
  fold.triangles = (Triangles(2, 3) << 0, 1, 2, 1, 0, 3).finished();
  EXPECT_EQ(self_intersections(fold).size(), 1u);
  fold.points(3, 2) = 1e-12;
  EXPECT_TRUE(self_intersections(fold).empty());
  fold.points.row(3) << 0.6, -0.8, 0;
  EXPECT_TRUE(self_intersections(fold).empty());
}
TEST(SelfIntersections, OfSomeTrianglesAreThosePairsOfAllThatHaveOneOfThem) {
  TriMesh mesh = test::icosphere(3);
  mesh.points.row(3) *= -1.05;
  std::vector<Index> some;
  for (Index t = 0; t < mesh.n_triangles(); t += 3) some.push_back(t);
  auto expected = self_intersections(mesh);
  std::erase_if(expected, [](const auto& pair) { return pair[0] % 3 != 0 && pair[1] % 3 != 0; });
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(self_intersections(mesh, some), expected);
}
TEST(SelfIntersections, AreTheSameForOneAndEightThreads) {
  TriMesh mesh = test::icosphere(3);
  mesh.points.row(3) *= -1.05;
  const auto run = [&] { return self_intersections(mesh); };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

}  // namespace coxa
