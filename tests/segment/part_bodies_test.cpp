#include <coxa/segment/part_bodies.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/validate.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace coxa::segment {

TriMesh ball_at(double x, double radius) {
  TriMesh mesh = test::icosphere(3, radius);
  mesh.points.col(0).array() += x;
  return mesh;
}
/// Greatest depth of points spread over `mesh` in another, mm: an own check by many points.
double depth_in(const TriMesh& mesh, const TriMesh& other) {
  const TriangleTree tree(other.points, other.triangles);
  const Points points = sample_surface(mesh, 20000, 3);
  double deepest = 0.0;
  for (Index i = 0; i < static_cast<Index>(points.rows()); ++i)
    deepest = std::max(deepest, -tree.signed_distance(points.row(i).transpose()));
  return deepest;
}

TEST(PartBodies, PartsSoftOnesHalfWayAndNeverMovesFirmOnes) {
  TriMesh left = ball_at(-9.0, 10.0), right = ball_at(9.0, 10.0);
  const TriMesh below = [] {
    TriMesh mesh = ball_at(0.0, 10.0);
    mesh.points.col(2).array() -= 15.5;
    return mesh;
  }();
  ASSERT_GT(depth_in(left, right), 1.5);
  ASSERT_GT(depth_in(left, below), 1.0);
  EXPECT_LE(update_parted({{&left}, {&right}}, {&below}), 0.02);
  for (const TriMesh* mesh : {&left, &right}) {
    EXPECT_TRUE(validate(*mesh).valid()) << validate(*mesh).text();
    EXPECT_LT(depth_in(*mesh, below), 0.05);
  }
  EXPECT_LT(depth_in(left, right), 0.05);
  EXPECT_LT(depth_in(right, left), 0.05);
  EXPECT_NEAR(left.points.col(0).maxCoeff(), 0.0, 0.3);
  EXPECT_NEAR(right.points.col(0).minCoeff(), 0.0, 0.3);
  EXPECT_NEAR(volume(left), volume(right), 0.01 * volume(left));
}
TEST(PartBodies, LeavesWhatIsApart) {
  TriMesh left = ball_at(-11.0, 10.0), right = ball_at(11.0, 10.0);
  const Points before = left.points;
  EXPECT_EQ(update_parted({{&left}, {&right}}, {}), 0.0);
  EXPECT_EQ(left.points, before);
}
TEST(PartBodies, IsTheSameForOneAndEightThreads) {
  TriMesh a = ball_at(-9.0, 10.0), b = ball_at(9.0, 10.0), c = a, d = b;
  set_thread_count(1);
  update_parted({{&a}, {&b}}, {});
  set_thread_count(8);
  update_parted({{&c}, {&d}}, {});
  EXPECT_EQ(a.points, c.points);
  EXPECT_EQ(b.points, d.points);
}

}  // namespace coxa::segment
