#include <coxa/segment/lay_on_hosts.h>

#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/validate.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/shapes.h"

namespace coxa::segment {

/// A spherical shell, outward: its first half of vertices on the inner sphere.
TriMesh shell(double inner, double outer) {
  return test::together(test::turned_over(test::icosphere(4, inner)), test::icosphere(4, outer));
}
double mean_radius(const Points& points) { return points.rowwise().norm().mean(); }

class LayOnHosts : public ::testing::Test {
 protected:
  void lay(double gap) {
    std::vector<LaidLayer> layers{{&inner_, &ball_, 0}, {&outer_, &cup_, 0}};
    lay_on_hosts(layers, gap);
  }
  Index half() const { return inner_.n_vertices() / 2; }
  const TriMesh ball_ = test::icosphere(4, 20.0);
  const TriMesh cup_ = test::turned_over(test::icosphere(4, 23.0));
  TriMesh inner_ = shell(19.8, 22.0), outer_ = shell(21.5, 23.2);
};

TEST_F(LayOnHosts, SeatsTheFacingSidesAndSharesTheRoomByThickness) {
  lay(0.1);
  const double seat = 0.05, room = 3.0 - 0.1 - 2 * seat, inner = 1.95, outer = 1.45;
  EXPECT_NEAR(mean_radius(inner_.points.topRows(half())), 20.0 + seat, 0.02);
  EXPECT_NEAR(mean_radius(inner_.points.bottomRows(half())),
              20.0 + seat + room * inner / (inner + outer), 0.03);
  EXPECT_NEAR(mean_radius(outer_.points.topRows(half())),
              23.0 - seat - room * outer / (inner + outer), 0.03);
  EXPECT_NEAR(mean_radius(outer_.points.bottomRows(half())), 23.0 - seat, 0.02);
  EXPECT_GT(
      mean_radius(outer_.points.topRows(half())) - mean_radius(inner_.points.bottomRows(half())),
      0.07);
}
TEST_F(LayOnHosts, LeavesTheFarSideWhereThereIsRoom) {
  inner_ = shell(20.05, 21.0);
  outer_ = shell(22.0, 22.95);
  lay(0.1);
  EXPECT_NEAR(mean_radius(inner_.points.bottomRows(half())), 21.0, 0.02);
  EXPECT_NEAR(mean_radius(outer_.points.topRows(half())), 22.0, 0.02);
}
TEST_F(LayOnHosts, BringsAFloatingLayerDown) {
  inner_ = shell(21.0, 22.0);
  std::vector<LaidLayer> layers{{&inner_, &ball_, 0}};
  lay_on_hosts(layers, 0.0);
  // its own thickness, and the third of a millimetre that a height is believed beyond it
  EXPECT_NEAR(mean_radius(inner_.points.bottomRows(half())), 20.05 + 1.3, 0.02);
}
TEST_F(LayOnHosts, TakesTrianglesOutOfWhatTheyCut) {
  // large triangles of a sheet of 0.15 mm cut 0.3 mm off the ball between their corners
  TriMesh coarse =
      test::together(test::turned_over(test::icosphere(2, 20.05)), test::icosphere(2, 20.2));
  const auto depth_of = [](const TriMesh& mesh, const TriMesh& other) {
    const TriangleTree tree(other.points, other.triangles);
    const Points points = sample_surface(mesh, 20000, 3);
    double deepest = 0.0;
    for (const auto& p : points.rowwise())
      deepest = std::max(deepest, -tree.signed_distance(p.transpose()));
    return deepest;
  };
  ASSERT_GT(depth_of(coarse, ball_), 0.2);
  std::vector<LaidLayer> layers{{&coarse, &ball_, coarse.n_triangles() / 2}};
  EXPECT_LE(lay_on_hosts(layers, 0.0), 0.01);
  EXPECT_LE(depth_of(coarse, ball_), 0.05);
  EXPECT_LE(depth_of(ball_, coarse), 0.05);
  EXPECT_TRUE(self_intersections(coarse).empty());
  const Index n = coarse.n_vertices() / 2;
  EXPECT_NEAR(mean_radius(coarse.points.bottomRows(n)) - mean_radius(coarse.points.topRows(n)),
              0.15, 0.03);
}

}  // namespace coxa::segment
