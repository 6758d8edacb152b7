#include <coxa/geom/triangle_tree.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/closest_point.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <Eigen/Dense>

namespace coxa {

NearestPoint nearest_by_brute_force(const TriangleTree& tree, const Vec3& p) {
  NearestPoint best;
  best.squared_distance = kInfinity;
  for (Index t = 0; t < tree.triangles().rows(); ++t) {
    const auto corner = [&](int k) { return Vec3(tree.points().row(tree.triangles()(t, k))); };
    const TrianglePoint q = closest_point_on_triangle(p, corner(0), corner(1), corner(2));
    if (q.squared_distance < best.squared_distance)
      best = {t, q.point, q.barycentric, q.squared_distance};
  }
  return best;
}

TriangleTree tree_of(const TriMesh& mesh) { return {mesh.points, mesh.triangles}; }

// triangles thrown at random, of very different sizes: nothing a mesh would guarantee
TriangleTree soup(std::uint64_t seed) {
  const Index n = 400;
  Points points = test::random_points(3 * n, 10.0, seed);
  for (Index t = 0; t < n; ++t)
    for (int k = 1; k < 3; ++k) {
      const double size = std::pow(10.0, -(t % 5));
      points.row(3 * t + k) = points.row(3 * t) + 0.1 * size * points.row(3 * t + k);
    }
  Triangles triangles(n, 3);
  for (Index i = 0; i < 3 * n; ++i) triangles.data()[i] = i;
  return {points, triangles};
}

TEST(TriangleTree, NearestEqualsBruteForceOnTriangleSoup) {
  const TriangleTree tree = soup(1);
  const Points queries = test::random_points(500, 15.0, 2);
  for (Index i = 0; i < queries.rows(); ++i) {
    const Vec3 p = queries.row(i);
    const NearestPoint expected = nearest_by_brute_force(tree, p), found = tree.nearest(p);
    ASSERT_EQ(found.triangle, expected.triangle);
    ASSERT_EQ(found.squared_distance, expected.squared_distance);
    ASSERT_EQ(found.point, expected.point);
    ASSERT_EQ(found.barycentric, expected.barycentric);
  }
}
TEST(TriangleTree, BreaksTiesByTheLowerTriangle) {
  // at the vertices of a mesh all triangles around the vertex are equally near
  const TriMesh mesh = test::icosphere(3);
  const TriangleTree tree = tree_of(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v);
    ASSERT_EQ(tree.nearest(p).triangle, nearest_by_brute_force(tree, p).triangle);
    ASSERT_EQ(tree.nearest(1.5 * p).triangle, nearest_by_brute_force(tree, 1.5 * p).triangle);
  }
}
TEST(TriangleTree, NearestWithinKeepsPointsAtExactlyTheLimitAndDropsThoseBeyond) {
  const TriangleTree tree = tree_of(test::plate(0.0));
  EXPECT_TRUE(tree.nearest_within(Vec3(0.3, 0.2, 2.0), 2.0).has_value());
  EXPECT_FALSE(tree.nearest_within(Vec3(0.3, 0.2, 2.0), 2.0 - 1e-9).has_value());
  EXPECT_FALSE(tree.nearest_within(Vec3(0.3, 0.2, 2.0), -1.0).has_value());
}
TEST(TriangleTree, AnswersAfterUpdateAsANewTreeWould) {
  const TriMesh mesh = test::lunate_shell();
  TriMesh bent = mesh;
  for (Index v = 0; v < bent.n_vertices(); ++v)
    bent.points(v, 2) += 0.02 * bent.points(v, 0) * bent.points(v, 0);
  TriangleTree refitted = tree_of(mesh);
  refitted.update_points(bent.points);
  const TriangleTree fresh = tree_of(bent);
  const Points queries = test::random_points(300, 40.0, 3);
  for (Index i = 0; i < queries.rows(); ++i) {
    const Vec3 p = queries.row(i);
    ASSERT_EQ(refitted.nearest(p).triangle, fresh.nearest(p).triangle);
    ASSERT_EQ(refitted.signed_distance(p), fresh.signed_distance(p));
  }
}
TEST(TriangleTree, IsBuiltAndSearchedWhereAllTrianglesCoincide) {
  TriMesh mesh = test::plate(0.0, 1.0, 1);
  const Triangles two = mesh.triangles;
  mesh.triangles.resize(2000, 3);
  for (Index t = 0; t < 2000; ++t) mesh.triangles.row(t) = two.row(t % 2);
  EXPECT_EQ(tree_of(mesh).nearest(Vec3(0.5, -0.5, 3.0)).triangle, 0);
}
TEST(TriangleTree, FirstHitEqualsBruteForceOverRays) {
  const TriangleTree tree = soup(5);
  const Points origins = test::random_points(2000, 12.0, 6),
               ends = test::random_points(2000, 12.0, 7);
  int hits = 0;
  for (Index i = 0; i < origins.rows(); ++i) {
    const Vec3 origin = origins.row(i), direction = (ends.row(i) - origins.row(i)).normalized();
    double expected = kInfinity;
    for (Index t = 0; t < tree.triangles().rows(); ++t) {
      const Vec3 a = tree.points().row(3 * t), b = tree.points().row(3 * t + 1),
                 c = tree.points().row(3 * t + 2);
      Mat3 system;
      system << b - a, c - a, -direction;
      const Vec3 x = system.fullPivLu().solve(origin - a);
      if (x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && x[2] >= 0)
        expected = std::min(expected, x[2]);
    }
    const auto hit = tree.first_hit(origin, direction, 100.0);
    ASSERT_EQ(hit.has_value(), expected < kInfinity);
    if (hit) {
      ASSERT_NEAR(hit->distance, expected, 1e-9);
      ASSERT_FALSE(tree.first_hit(origin, direction, expected * (1.0 - 1e-9)).has_value());
      ++hits;
    }
  }
  EXPECT_GT(hits, 10);
}
TEST(TriangleTree, NoRayFromInsideSlipsBetweenTriangles) {
  // aimed exactly at vertices and edge midpoints, where rounding opens cracks
  const TriMesh mesh = test::moved(test::icosphere(3), test::some_pose());
  const TriangleTree tree = tree_of(mesh);
  const Vec3 centre = test::some_pose().p;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.points.row(mesh.triangles(t, k)),
                 b = mesh.points.row(mesh.triangles(t, (k + 1) % 3));
      ASSERT_TRUE(tree.first_hit(centre, (a - centre).normalized(), 20.0).has_value());
      ASSERT_TRUE(tree.first_hit(centre, (0.5 * (a + b) - centre).normalized(), 20.0).has_value());
    }
}
TEST(TriangleTree, AxisAlignedRaysHitPlatesFromBothSides) {
  const TriangleTree tree = tree_of(test::plate(2.0));
  EXPECT_EQ(tree.first_hit(Vec3(0.5, 0.5, 0.0), Vec3::UnitZ(), 10.0)->distance, 2.0);
  EXPECT_EQ(tree.first_hit(Vec3(0.5, 0.5, 5.0), -Vec3::UnitZ(), 10.0)->distance, 3.0);
  EXPECT_EQ(tree.first_hit(Vec3(0.0, 0.0, 0.0), Vec3::UnitZ(), 2.0)->distance, 2.0);
  EXPECT_FALSE(tree.first_hit(Vec3(0.5, 0.5, 0.0), -Vec3::UnitZ(), 10.0).has_value());
}
TEST(TriangleTree, OverlappingListsTrianglesWhoseBoxesMeetTheBox) {
  const TriangleTree tree = soup(9);
  const Vec3 low(-2.0, -3.0, -1.0), high(4.0, 1.0, 3.0);
  std::vector<Index> expected;
  for (Index t = 0; t < tree.triangles().rows(); ++t) {
    const Mat3 corners = tree.points().middleRows<3>(3 * t);
    const Vec3 box_low = corners.colwise().minCoeff(), box_high = corners.colwise().maxCoeff();
    if ((box_low.array() <= high.array()).all() && (box_high.array() >= low.array()).all())
      expected.push_back(t);
  }
  EXPECT_EQ(tree.overlapping(low, high), expected);
  EXPECT_FALSE(expected.empty());
}
TEST(TriangleTree, SignedDistanceToABoxIsExact) {
  const TriangleTree tree = tree_of(test::box(Vec3(-1, -2, -3), Vec3(1, 2, 3)));
  const Points queries = test::random_points(2000, 5.0, 11);
  for (Index i = 0; i < queries.rows(); ++i) {
    const Vec3 d = queries.row(i).transpose().cwiseAbs() - Vec3(1, 2, 3);
    const double expected = d.maxCoeff() > 0 ? d.cwiseMax(0.0).norm() : d.maxCoeff();
    ASSERT_NEAR(tree.signed_distance(queries.row(i)), expected, 1e-12);
  }
}
TEST(TriangleTree, SignIsRightBesideSharpEdgesAndVertices) {
  // a thin wedge: face normals alone mislead beyond its sharp edge
  TriMesh wedge;
  wedge.points.resize(4, 3);
  wedge.points << 0, 0, 0, 10, 0, -1, 10, 0, 1, 5, 10, 0;
  wedge.triangles.resize(4, 3);
  wedge.triangles << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2;
  const TriangleTree tree = tree_of(wedge);
  const Points queries = test::random_points(3000, 15.0, 12);
  for (Index i = 0; i < queries.rows(); ++i) {
    const Vec3 p = queries.row(i);
    bool inside = true;
    for (Index t = 0; t < 4; ++t) {
      const Vec3 a = wedge.points.row(wedge.triangles(t, 0)),
                 b = wedge.points.row(wedge.triangles(t, 1)),
                 c = wedge.points.row(wedge.triangles(t, 2));
      inside = inside && (p - a).dot((b - a).cross(c - a)) < 0.0;
    }
    ASSERT_EQ(tree.signed_distance(p) < 0.0, inside);
  }
}
TEST(TriangleTree, IsBitIdenticalForOneAndEightThreads) {
  const TriangleTree tree = tree_of(test::icosphere(3));
  const Points queries = test::random_points(2000, 15.0, 13);
  const auto distances = [&] {
    VecX d(queries.rows());
    parallel_for(queries.rows(), [&](Index i) { d[i] = tree.signed_distance(queries.row(i)); });
    return d;
  };
  EXPECT_EQ(with_threads(1, distances), with_threads(8, distances));
}
TEST(TriangleTree, RejectsEmptySurfacesBadIndicesAndNonFinitePoints) {
  TriMesh mesh = test::box();
  EXPECT_THROW(TriangleTree(mesh.points, Triangles(0, 3)), Error);
  mesh.triangles(3, 1) = 8;
  EXPECT_THROW(tree_of(mesh), Error);
  mesh = test::box();
  mesh.points(2, 0) = kNaN;
  EXPECT_THROW(tree_of(mesh), Error);
  TriangleTree tree = tree_of(test::box());
  EXPECT_THROW(tree.update_points(Points::Zero(7, 3)), Error);
  EXPECT_THROW(tree.nearest(Vec3(kNaN, 0, 0)), Error);
}

}  // namespace coxa
