#include "meshing/feature_curves.h"

#include <coxa/core/rng.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/topology.h>
#include <coxa/meshing/mesh_surface.h>
#include <gtest/gtest.h>
#include "grids.h"
#include "support/shapes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace coxa::meshing {
namespace {

/// With n sides; its top is `top` times as wide as its bottom and moved by `lean`.
TriMesh prism(Index n, double radius, double height, double top = 1.0, const Vec2& lean = {0, 0}) {
  TriMesh mesh;
  mesh.points.resize(2 * n + 2, 3);
  mesh.triangles.resize(4 * n, 3);
  for (Index k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * k / n;
    const Vec2 p = radius * Vec2(std::cos(a), std::sin(a)), q = top * p + lean;
    mesh.points.row(k) << p[0], p[1], 0.0;
    mesh.points.row(n + k) << q[0], q[1], height;
    const Index l = (k + 1) % n;
    mesh.triangles.row(4 * k) << k, l, n + k;
    mesh.triangles.row(4 * k + 1) << l, n + l, n + k;
    mesh.triangles.row(4 * k + 2) << l, k, 2 * n;
    mesh.triangles.row(4 * k + 3) << n + k, n + l, 2 * n + 1;
  }
  mesh.points.row(2 * n) << 0.0, 0.0, 0.0;
  mesh.points.row(2 * n + 1) << lean[0], lean[1], height;
  return mesh;
}

TriMesh random_prism(std::uint64_t seed) {
  Rng rng(seed);
  const auto n = static_cast<Index>(rng.uniform(3.0, 9.0));
  const double radius = rng.uniform(5.0, 12.0), height = rng.uniform(4.0, 16.0);
  const double top = rng.uniform(0.5, 1.0);
  const Vec2 lean(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0));
  TriMesh mesh = prism(n, radius, height, top, lean);
  const Vec3 axis(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
  const Mat3 R = Eigen::AngleAxisd(rng.uniform(0.0, kPi), axis.normalized()).toRotationMatrix();
  mesh.points = (mesh.points * R.transpose()).eval();
  return mesh;
}

TEST(FeatureCurves, OfABoxAreItsEdgesAndCorners) {
  const FeatureCurves found = feature_curves(coxa::test::box(), 0.1);
  ASSERT_EQ(found.curves.size(), 12u);
  EXPECT_EQ(found.corners.size(), 8u);
  for (const FeatureCurve& curve : found.curves) {
    EXPECT_NEAR(curve.length(), 2.0, 1e-12);
    EXPECT_NE(curve.first, curve.last);
    EXPECT_EQ(found.corners[static_cast<std::size_t>(curve.first)], curve.points.front());
    EXPECT_EQ(found.corners[static_cast<std::size_t>(curve.last)], curve.points.back());
  }
  const CurvePlace place = found.nearest(Vec3(1.3, 0.2, 1.4));
  EXPECT_TRUE(place.point.isApprox(Vec3(1.0, 0.2, 1.0)));
  EXPECT_NEAR(std::abs(place.direction[1]), 1.0, 1e-12);
  EXPECT_NEAR(place.distance, 0.5, 1e-12);
}

TEST(FeatureCurves, OfACylinderAreTwoClosedOnes) {
  const FeatureCurves found = feature_curves(prism(40, 8.0, 12.0), 1.0);
  ASSERT_EQ(found.curves.size(), 2u);
  EXPECT_TRUE(found.corners.empty());
  for (const FeatureCurve& curve : found.curves) {
    EXPECT_TRUE(curve.closed());
    EXPECT_EQ(curve.points.size(), 40u);
    EXPECT_NEAR(curve.length(), 80.0 * 8.0 * std::sin(kPi / 40.0), 1e-9);
  }
}

TEST(FeatureCurves, LeavesOutWhatIsSmoothOrShort) {
  EXPECT_TRUE(feature_curves(coxa::test::icosphere(2), 0.0).curves.empty());
  EXPECT_TRUE(feature_curves(coxa::test::box(), 2.1).curves.empty());
}

// COXA_RANDOM_PRISMS sets how many are tried
TEST(FeatureCurves, PrismsAreMetAtTheirRidges) {
  constexpr int kFew = 3;
  const char* text = std::getenv("COXA_RANDOM_PRISMS");
  const int last = text != nullptr ? std::atoi(text) : kFew;
  for (int seed = 1; seed <= last; ++seed) {
    const TriMesh body = random_prism(static_cast<std::uint64_t>(seed));
    const MeshingResult made = mesh_surface(body, {.method = Method::lattice, .max_tets = 4000});
    const TriMesh skin = test::envelope(made.mesh);
    EXPECT_EQ(manifold_fault(skin), "") << seed;
    EXPECT_LE(made.mesh.n_tets(), 4000) << seed;
    EXPECT_LE(surface_distance(skin, body).hd, 0.3) << seed;
    EXPECT_TRUE(meets_limits(made.report)) << seed;
  }
}

}  // namespace
}  // namespace coxa::meshing
