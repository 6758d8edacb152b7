#include <coxa/geom/closest_point.h>

#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

// nearest over a fine barycentric sampling: an upper bound that shrinks with the sampling
double sampled_squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int n = 200;
  double best = kInfinity;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 q = (double(n - i - j) * a + double(i) * b + double(j) * c) / n;
      best = std::min(best, (p - q).squaredNorm());
    }
  return best;
}

TEST(ClosestPointOnTriangle, IsNeverFartherThanAnySampleAndLiesOnTheTriangle) {
  const Points random = test::random_points(4 * 60, 10.0, 21);
  for (Index i = 0; i < 60; ++i) {
    const Vec3 p = 2.0 * random.row(4 * i).transpose(), a = random.row(4 * i + 1),
               b = random.row(4 * i + 2), c = random.row(4 * i + 3);
    const TrianglePoint q = closest_point_on_triangle(p, a, b, c);
    EXPECT_LE(q.squared_distance, sampled_squared_distance(p, a, b, c) + 1e-9);
    EXPECT_GE(q.squared_distance, sampled_squared_distance(p, a, b, c) - 3.0);
    EXPECT_GE(q.barycentric.minCoeff(), 0.0);
    EXPECT_NEAR(q.barycentric.sum(), 1.0, 1e-14);
    EXPECT_LE((q.barycentric[0] * a + q.barycentric[1] * b + q.barycentric[2] * c - q.point).norm(),
              1e-12);
    EXPECT_EQ(q.squared_distance, (p - q.point).squaredNorm());
  }
}
TEST(ClosestPointOnTriangle, IsContinuousAcrossEveryRegionBorder) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(1, 3, 0);
  // borders of the vertex regions leave the corners at right angles to the edges
  const Vec3 corners[3] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const Vec3 corner = corners[k];
    for (const Vec3& edge :
         {Vec3(corners[(k + 1) % 3] - corner), Vec3(corners[(k + 2) % 3] - corner)}) {
      const Vec3 along = edge.normalized();
      Vec3 outward = along.cross(Vec3::UnitZ());
      if (outward.dot((a + b + c) / 3.0 - corner) > 0) outward = -outward;
      for (double height : {-1.0, 0.0, 2.0})
        for (double away : {0.0, 1e-9, 0.5, 10.0}) {
          const Vec3 border = corner + away * outward + height * Vec3::UnitZ();
          for (double beside : {-1e-12, 0.0, 1e-12}) {
            const TrianglePoint q = closest_point_on_triangle(border + beside * along, a, b, c);
            EXPECT_LE((q.point - corner).norm(), 1e-11);
          }
        }
    }
    // and edge regions end at the edges
    const Vec3 from = corners[k], to = corners[(k + 1) % 3], middle = 0.3 * from + 0.7 * to;
    for (double beside : {-1e-12, 0.0, 1e-12}) {
      const Vec3 inward = Vec3::UnitZ().cross(to - from).normalized();
      const TrianglePoint q =
          closest_point_on_triangle(middle + beside * inward + Vec3::UnitZ(), a, b, c);
      EXPECT_LE((q.point - middle).norm(), 1e-11);
    }
  }
}
TEST(ClosestPointOnTriangle, GivesExactZerosOnVerticesAndEdges) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(1, 3, 0);
  EXPECT_EQ(closest_point_on_triangle(Vec3(-1, -1, 2), a, b, c).barycentric, Vec3(1, 0, 0));
  EXPECT_EQ(closest_point_on_triangle(Vec3(9, -1, 2), a, b, c).barycentric, Vec3(0, 1, 0));
  EXPECT_EQ(closest_point_on_triangle(Vec3(1, 9, 2), a, b, c).barycentric, Vec3(0, 0, 1));
  EXPECT_EQ(closest_point_on_triangle(Vec3(1, -5, 2), a, b, c).barycentric, Vec3(0.75, 0.25, 0));
}
TEST(ClosestPointOnTriangle, TreatsATriangleWithoutAreaAsItsEdges) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(3, 0, 0);
  for (const auto& [p, expected] : {std::pair{Vec3(2, 1, 0), Vec3(2, 0, 0)},
                                    {Vec3(0.5, 1, 0), Vec3(0.5, 0, 0)},
                                    {Vec3(5, 1, 0), Vec3(3, 0, 0)},
                                    {Vec3(-1, 0, 0), Vec3(0, 0, 0)}}) {
    EXPECT_LE((closest_point_on_triangle(p, a, b, c).point - expected).norm(), 1e-14);
    EXPECT_LE((closest_point_on_triangle(p, c, a, b).point - expected).norm(), 1e-14);
    EXPECT_LE((closest_point_on_triangle(p, a, a, c).point - (expected)).norm(), 1e-14);
  }
  EXPECT_EQ(closest_point_on_triangle(Vec3(5, 1, 0), b, b, b).point, b);
}
TEST(ClosestParameterOnSegment, IsClampedToTheEnds) {
  const Vec3 a(0, 0, 0), b(2, 0, 0);
  EXPECT_EQ(closest_parameter_on_segment(Vec3(0.5, 1, 1), a, b), 0.25);
  EXPECT_EQ(closest_parameter_on_segment(Vec3(-1, 1, 1), a, b), 0.0);
  EXPECT_EQ(closest_parameter_on_segment(Vec3(7, 1, 1), a, b), 1.0);
  EXPECT_EQ(closest_parameter_on_segment(Vec3(7, 1, 1), a, a), 0.0);
}

}  // namespace coxa
