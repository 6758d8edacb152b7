#include <coxa/geom/predicates.h>

#include <gtest/gtest.h>
#include "support/shapes.h"

#include <cmath>

namespace coxa {

TEST(Orientation, IsPositiveWhereTheTriangleIsSeenCounterClockwise) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(orientation(a, b, c, Vec3(0.3, 0.3, 1)), 1);
  EXPECT_EQ(orientation(a, b, c, Vec3(0.3, 0.3, -1)), -1);
  EXPECT_EQ(orientation(a, b, c, Vec3(7, -8, 0)), 0);
}
TEST(Orientation, IsAntisymmetricWhereRoundingWouldLie) {
  // d within rounding of the plane through a, b, c: swapping points must flip the sign, always
  Rng rng(4);
  int zero = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a = rng.normal3(), b = rng.normal3(), c = rng.normal3();
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3 d = a + u * (b - a) + v * (c - a);
    const int s = orientation(a, b, c, d);
    ASSERT_EQ(orientation(b, a, c, d), -s);
    ASSERT_EQ(orientation(a, b, d, c), -s);
    ASSERT_EQ(orientation(d, a, b, c), -s);
    ASSERT_EQ(orientation(b, c, a, d), s);
    zero += s == 0;
  }
  EXPECT_LT(zero, 2000);
}
TEST(Orientation, SeesTheLastBit) {
  const Vec3 a(0, 0, 1), b(1, 0, 1), c(0, 1, 1);
  EXPECT_EQ(orientation(a, b, c, Vec3(0.25, 0.25, std::nextafter(1.0, 2.0))), 1);
  EXPECT_EQ(orientation(a, b, c, Vec3(0.25, 0.25, std::nextafter(1.0, 0.0))), -1);
  EXPECT_EQ(
      orientation_in_plane(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, std::nextafter(2.0, 3.0), 0), 2),
      1);
  EXPECT_EQ(orientation_in_plane(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(3, 3, 0), 2), 0);
}
TEST(TrianglesMeet, KnowsCrossingTouchingAndMissing) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_TRUE(triangles_meet(a, b, c, Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(5, 5, 1)));  // pierced
  EXPECT_TRUE(
      triangles_meet(a, b, c, Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(5, 5, 1)));  // touched by a vertex
  EXPECT_TRUE(
      triangles_meet(a, b, c, Vec3(2, 0, -1), Vec3(2, 0, 1), Vec3(2, -5, 0)));  // edge through edge
  EXPECT_FALSE(triangles_meet(a, b, c, Vec3(1, 1, 1e-300), Vec3(1, 1, 1), Vec3(5, 5, 1)));
  EXPECT_FALSE(triangles_meet(a, b, c, Vec3(3, 3, -1), Vec3(3, 3, 1), Vec3(5, 5, 1)));
  EXPECT_TRUE(
      triangles_meet(a, b, c, Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(1, 2, 0)));  // inside, one plane
  EXPECT_TRUE(triangles_meet(a, b, c, Vec3(-9, -9, 0), Vec3(90, -9, 0),
                             Vec3(-9, 90, 0)));  // around, one plane
  EXPECT_TRUE(
      triangles_meet(a, b, c, Vec3(2, 2, 0), Vec3(9, 2, 0), Vec3(2, 9, 0)));  // touching, one plane
  EXPECT_FALSE(triangles_meet(a, b, c, Vec3(2.1, 2, 0), Vec3(9, 2, 0), Vec3(2.1, 9, 0)));
}
TEST(TrianglesMeet, IsSymmetricAndAgreesWithSampling) {
  // random pairs: a shared point found by fine sampling of one triangle's interior against the
  // other's plane
  Rng rng(8);
  int meeting = 0;
  for (int i = 0; i < 500; ++i) {
    Vec3 p[6];
    for (Vec3& q : p) q = rng.normal3();
    const bool meets = triangles_meet(p[0], p[1], p[2], p[3], p[4], p[5]);
    ASSERT_EQ(meets, triangles_meet(p[4], p[3], p[5], p[2], p[0], p[1]));
    // lines of one triangle that cross the other's plane inside it
    const Vec3 n = (p[4] - p[3]).cross(p[5] - p[3]);
    bool sampled = false;
    for (int j = 0; j <= 400 && !sampled; ++j) {
      const double s = j / 400.0;
      const Vec3 from = p[0] + s * (p[1] - p[0]), to = p[2];
      const double f = n.dot(from - p[3]), g = n.dot(to - p[3]);
      if (f * g > 0) continue;
      const Vec3 x = from + f / (f - g) * (to - from);
      sampled = n.dot((p[4] - p[3]).cross(x - p[3])) >= 0 &&
                n.dot((p[5] - p[4]).cross(x - p[4])) >= 0 &&
                n.dot((p[3] - p[5]).cross(x - p[5])) >= 0;
    }
    ASSERT_TRUE(meets || !sampled);
    meeting += meets;
  }
  EXPECT_GT(meeting, 50);
  EXPECT_LT(meeting, 300);
}

}  // namespace coxa
