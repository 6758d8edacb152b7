#include <coxa/segment/part_bodies.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/validate.h>
#include <coxa/segment/separate_bodies.h>
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

Surface shown(TriMesh mesh, double value) {
  Surface surface{std::move(mesh), {}};
  surface.fields["confidence"] = VecX::Constant(surface.mesh.n_vertices(), value);
  surface.fields["completed"] = VecX::Ones(surface.mesh.n_vertices());
  return surface;
}

TEST(SeparateBodies, TheLessConfirmedGivesWayToTheBetterAndToWhatIsFirm) {
  const TriMesh bone = ball_at(0.0, 6.0);
  const Surface better = shown(ball_at(11.0, 7.0), 0.9), worse = shown(ball_at(20.0, 8.0), 0.5);
  const auto separated = [&] {
    std::vector<Surface> both{worse, better};
    EXPECT_TRUE(
        update_separated({{"worse", &both[0], 0.4}, {"better", &both[1], 0.8}}, {&bone}).empty());
    return both;
  };
  const std::vector<Surface> both = separated();
  for (const Surface& surface : both) {
    EXPECT_TRUE(validate(surface.mesh).valid()) << validate(surface.mesh).text();
    EXPECT_LE(depth_in(surface.mesh, bone), 0.02);
    EXPECT_EQ(surface.fields.at("completed").size(), surface.mesh.n_vertices());
    EXPECT_EQ(surface.fields.at("completed").minCoeff(), 1.0);
  }
  EXPECT_LE(depth_in(both[0].mesh, both[1].mesh), 0.02);
  EXPECT_LE(depth_in(both[1].mesh, both[0].mesh), 0.02);
  EXPECT_NEAR(both[0].fields.at("confidence").mean(), 0.5, 1e-9);
  // the better one loses to the bone only, the other all of what they share
  EXPECT_GT(both[1].mesh.points.col(0).maxCoeff(), 17.7);
  EXPECT_NEAR(both[0].mesh.points.col(0).maxCoeff(), 28.0, 0.2);
  const auto serial = with_threads(1, separated);
  EXPECT_EQ(serial[0].mesh.points, both[0].mesh.points);
}
TEST(SeparateBodies, StayBitForBitWhereTheyAreApartAndAreNamedWhereTheyLieInOthers) {
  std::vector<Surface> three{shown(ball_at(0.0, 10.0), 1.0), shown(ball_at(30.0, 10.0), 1.0),
                             shown(ball_at(2.0, 6.0), 1.0)};
  const std::vector<Surface> before = three;
  const auto texts = update_separated(
      {{"one", &three[0], 0.8}, {"two", &three[1], 0.8}, {"lost", &three[2], 0.1}}, {});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(three[k].mesh.points, before[k].mesh.points);
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_NE(texts.front().find("low confidence: of the lost"), std::string::npos);
}

}  // namespace coxa::segment
