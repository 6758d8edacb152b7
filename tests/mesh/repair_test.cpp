#include <coxa/mesh/repair.h>

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/validate.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <functional>

namespace coxa {

TriMesh without_triangles(const TriMesh& mesh, const std::function<bool(const Vec3&)>& drop) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (!drop(mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean())) kept.push_back(t);
  return sub_mesh(mesh, kept).mesh;
}
TriMesh as_soup(const TriMesh& mesh) {
  TriMesh soup;
  soup.points.resize(3 * mesh.n_triangles(), 3);
  soup.triangles.resize(mesh.n_triangles(), 3);
  for (Index i = 0; i < mesh.triangles.size(); ++i) {
    soup.points.row(i) = mesh.points.row(mesh.triangles.data()[i]);
    soup.triangles.data()[i] = i;
  }
  return soup;
}
std::string refusal(const TriMesh& mesh, const RepairOptions& options = {}) {
  try {
    repair(mesh, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_mesh);
    return error.what();
  }
  return {};
}

TEST(Repair, ReturnsAFlawlessSurfaceAsItIs) {
  const TriMesh torus = test::torus();
  const Repaired repaired = repair(torus);
  EXPECT_FALSE(repaired.report.changed());
  EXPECT_EQ(repaired.mesh.points, torus.points);
  EXPECT_EQ(repaired.mesh.triangles, torus.triangles);
}
TEST(Repair, DropsPointsNoTriangleUses) {
  TriMesh mesh = test::box();
  mesh.points.conservativeResize(9, 3);
  mesh.points.row(8) << 9, 9, 9;
  EXPECT_EQ(repair(mesh).report.dropped_points, 1);
  EXPECT_EQ(repair(mesh).mesh.points, test::box().points);
}
TEST(Repair, JoinsATriangleSoup) {
  const Repaired repaired = repair(as_soup(test::torus()));
  EXPECT_EQ(genus(repaired.mesh), 1);
  EXPECT_EQ(repaired.report.merged_points, 6 * 48 * 24 - 48 * 24);
  EXPECT_NEAR(volume(repaired.mesh), volume(test::torus()), 1e-9);
}
TEST(Repair, MergesPointsWithinTheDistanceOnly) {
  TriMesh soup = as_soup(test::box());
  soup.points += test::random_points(soup.points.rows(), 1e-4, 1);
  EXPECT_EQ(repair(soup, {.merge_distance = 1e-3}).mesh.n_vertices(), 8);
  EXPECT_NE(refusal(soup, {.merge_distance = 1e-9, .max_hole = 0.0}), "");
}
TEST(Repair, FillsSmallHolesAndSaysHowLong) {
  const TriMesh sphere = test::icosphere(3);
  const TriMesh open = without_triangles(sphere, [](const Vec3& c) { return c[2] > 9.0; });
  const Repaired repaired = repair(open);
  EXPECT_EQ(genus(repaired.mesh), 0);
  EXPECT_EQ(repaired.report.filled_holes, 1);
  EXPECT_GT(repaired.report.hole_triangles, 5);
  EXPECT_NEAR(repaired.report.longest_hole, 1.5 * 2 * kPi * 4.36, 5.0);  // a jagged circle at z = 9
  EXPECT_TRUE(validate(repaired.mesh).valid());
  EXPECT_NE(refusal(open, {.max_hole = 10.0}).find("hole with a border of"), std::string::npos);
}
TEST(Repair, DropsDuplicatesFinsAndDegenerateTriangles) {
  TriMesh mesh = test::box();
  mesh.points.conservativeResize(9, 3);
  mesh.points.row(8) << 0, 0, 5;
  mesh.triangles.conservativeResize(15, 3);
  mesh.triangles.row(12) = mesh.triangles.row(4);
  mesh.triangles.row(13) << 1, 1, 3;
  mesh.triangles.row(14) << 4, 5, 8;
  const Repaired repaired = repair(mesh);
  EXPECT_EQ(repaired.report.dropped_triangles, 3);
  EXPECT_EQ(repaired.report.dropped_points, 0);
  EXPECT_NEAR(volume(repaired.mesh), 8.0, 1e-12);
}
TEST(Repair, TurnsTrianglesToAgreeAndPiecesOutward) {
  TriMesh mesh = test::torus();
  for (Index t : {3, 100, 101, 700}) mesh.triangles.row(t).reverseInPlace();
  EXPECT_EQ(repair(mesh).report.turned_triangles, 4);
  EXPECT_NEAR(volume(repair(mesh).mesh), volume(test::torus()), 1e-9);
  mesh = test::torus();
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  EXPECT_EQ(repair(mesh).report.turned_triangles, mesh.n_triangles());
}
TriMesh both(const TriMesh& first, const TriMesh& second) {
  TriMesh mesh = first;
  mesh.points.conservativeResize(first.n_vertices() + second.n_vertices(), 3);
  mesh.points.bottomRows(second.n_vertices()) = second.points;
  mesh.triangles.conservativeResize(first.n_triangles() + second.n_triangles(), 3);
  mesh.triangles.bottomRows(second.n_triangles()) = second.triangles.array() + first.n_vertices();
  return mesh;
}
TEST(Repair, SeparatesBodiesThatTouchInAVertex) {
  const Repaired repaired = repair(both(test::box(), test::box(Vec3(1, 1, 1), Vec3(2, 2, 2))));
  EXPECT_TRUE(validate(repaired.mesh).valid()) << validate(repaired.mesh).text();
  EXPECT_EQ(repaired.report.merged_points, 1);
  EXPECT_EQ(repaired.report.split_vertices, 1);
  EXPECT_NEAR(volume(repaired.mesh), 9.0, 0.1);
  EXPECT_GT(repaired.report.largest_move, 0.0);
  EXPECT_LE(repaired.report.largest_move, 0.02);
}
TEST(Repair, SeparatesBodiesThatTouchInAnEdge) {
  const Repaired repaired = repair(
      both(test::box(Vec3(-1, -1, 0), Vec3(1, 1, 1)), test::box(Vec3(1, 1, 0), Vec3(2, 2, 1))));
  EXPECT_TRUE(validate(repaired.mesh).valid()) << validate(repaired.mesh).text();
  EXPECT_EQ(repaired.report.merged_points, 2);
  EXPECT_EQ(repaired.report.parted_edges, 2);
  EXPECT_NEAR(volume(repaired.mesh), 5.0, 0.1);
  EXPECT_LE(repaired.report.largest_move, 0.02);
}
TEST(Repair, DropsSheetsWithoutThickness) {
  TriMesh mesh = test::box();
  // a sheet of two triangles on an edge, and a wall of two that run opposite ways
  mesh.points.conservativeResize(10, 3);
  mesh.points.row(8) << mesh.points(4, 0), mesh.points(4, 1), 5.0;
  mesh.points.row(9) << mesh.points(5, 0), mesh.points(5, 1), 6.0;
  mesh.triangles.conservativeResize(16, 3);
  mesh.triangles.row(12) << 4, 5, 8;
  mesh.triangles.row(13) << 5, 9, 8;
  mesh.triangles.row(14) << 0, 1, 7;
  mesh.triangles.row(15) << 1, 0, 7;
  const Repaired repaired = repair(mesh);
  EXPECT_TRUE(validate(repaired.mesh).valid()) << validate(repaired.mesh).text();
  EXPECT_EQ(repaired.report.dropped_triangles, 4);
  EXPECT_NEAR(repaired.report.dropped_reach, 6.0 - mesh.points(5, 2), 1e-9);
  EXPECT_NEAR(volume(repaired.mesh), volume(test::box()), 1e-9);
}
TEST(Repair, RemovesNeedlesAndCaps) {
  TriMesh mesh = test::icosphere(2);
  // a vertex moved almost onto its neighbour makes needles
  const MeshEdges edges = mesh_edges(mesh);
  mesh.points.row(edges.vertices(0, 1)) = mesh.points.row(edges.vertices(0, 0)) * (1 - 1e-4) +
                                          mesh.points.row(edges.vertices(0, 1)) * 1e-4;
  ASSERT_TRUE(validate(mesh).has(FaultKind::sliver));
  const Repaired repaired = repair(mesh);
  EXPECT_GT(repaired.report.removed_slivers, 0);
  EXPECT_TRUE(validate(repaired.mesh).faults.empty());
  EXPECT_LT(repaired.report.largest_move, 1e-3);
}
TEST(Repair, CutsOutSelfIntersections) {
  TriMesh mesh = test::icosphere(4);
  // one vertex drawn over its neighbours
  const Index v = 700, w = vertex_neighbours(mesh)[v][0];
  mesh.points.row(v) += 2.5 * (mesh.points.row(w) - mesh.points.row(v));
  ASSERT_TRUE(validate(mesh).has(FaultKind::self_intersection));
  const Repaired repaired = repair(mesh, {.max_move = 2.0});
  EXPECT_TRUE(validate(repaired.mesh).valid()) << validate(repaired.mesh).text();
  EXPECT_GT(repaired.report.untangled_triangles, 0);
  EXPECT_GT(repaired.report.largest_move, 0.0);
  EXPECT_LT(repaired.report.largest_move, 2.0);
  EXPECT_NEAR(volume(repaired.mesh), volume(test::icosphere(4)), 5.0);
  EXPECT_NE(refusal(mesh, {.max_move = 1e-3}).find("would move the surface"), std::string::npos);
}
TEST(Repair, RefusesWhatItCannotRepairAndNamesThePlace) {
  TriMesh mesh = test::box();
  mesh.points(0, 0) = kNaN;
  EXPECT_NE(refusal(mesh).find("not finite"), std::string::npos);
  // three half planes on one edge, closed each by a box
  TriMesh band;  // Moebius band
  const Index n = 12;
  band.points.resize(2 * n, 3);
  band.triangles.resize(2 * n, 3);
  for (Index i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    for (Index s = 0; s < 2; ++s) {
      const double r = (s - 0.5) * 4.0;
      band.points.row(2 * i + s) << (10 + r * std::cos(a / 2)) * std::cos(a),
          (10 + r * std::cos(a / 2)) * std::sin(a), r * std::sin(a / 2);
    }
    const Index j = (i + 1) % n, c = i + 1 == n ? 2 * j + 1 : 2 * j,
                d = i + 1 == n ? 2 * j : 2 * j + 1;
    band.triangles.row(2 * i) << 2 * i, c, d;
    band.triangles.row(2 * i + 1) << 2 * i, d, 2 * i + 1;
  }
  EXPECT_NE(refusal(band).find("one-sided"), std::string::npos);
  EXPECT_THROW(repair({}), Error);
  EXPECT_THROW(repair(test::box(), {.merge_distance = -1.0}), Error);
  EXPECT_THROW(repair(test::box(), {.max_hole = -1.0}), Error);
  EXPECT_THROW(repair(test::box(), {.max_move = -1.0}), Error);
}
TEST(RepairReport, SaysWhatWasChanged) {
  const auto lines = repair(as_soup(test::box())).report.lines();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "28 points merged with another");
  EXPECT_EQ(lines[1], "the surface moved by at most 0 mm");
}

}  // namespace coxa
