#include <coxa/shape/registration.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/mesh/surface_distance.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

const TrustedSurface kBall{test::ellipsoid(Vec3(1.0, 1.0, 1.0)), {}};
const TrustedSurface kEgg{test::ellipsoid(Vec3(1.3, 0.9, 1.1)), {}};
const RegistrationOptions kQuick{
    .similarity_iterations = 5, .lengths = {20.0, 5.0, 2.0}, .iterations = 3};

TriMesh shaped(const TriMesh& topology, const Points& points) {
  return {points, topology.triangles};
}

TEST(Registration, LaysEveryVertexOnTheTarget) {
  const Points points = register_surface(kBall, kEgg, kQuick);
  const SurfaceDistance distance = surface_distance(shaped(kBall.mesh, points), kEgg.mesh);
  EXPECT_LT(distance.assd, 0.05);  // flat triangles of 1.5 mm on a radius of 10 mm
  EXPECT_LT(distance.hd, 0.3);
}

TEST(Registration, KeepsNeighboursApartAndUnfolded) {
  const TriMesh result = shaped(kBall.mesh, register_surface(kBall, kEgg, kQuick));
  for (Index t = 0; t < result.n_triangles(); ++t) {
    const Vec3 a = result.points.row(result.triangles(t, 0)),
               b = result.points.row(result.triangles(t, 1)),
               c = result.points.row(result.triangles(t, 2));
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0.0);  // star-shaped about the origin
  }
}

TEST(Registration, RecoversAPoseAndASizeBySimilarity) {
  TrustedSurface moved = kEgg;
  const Mat3 R = Eigen::AngleAxisd(0.15, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  moved.mesh.points = 1.1 * kEgg.mesh.points * R.transpose();
  moved.mesh.points.rowwise() += Vec3(2.0, -1.0, 1.5).transpose();
  const Points points = register_similarity(kEgg, moved, {.similarity_iterations = 60});
  // nearest points creep along the surface: the rest of the rotation is left to the elastic stages
  EXPECT_LT((points - moved.mesh.points).rowwise().norm().maxCoeff(), 0.8);
  EXPECT_GT((kEgg.mesh.points - moved.mesh.points).rowwise().norm().minCoeff(), 0.8);
}

TEST(Registration, CarriesOnWhereATargetIsCutOff) {
  // the lower part of the target is not anatomy: the full shape has to come from above
  TrustedSurface cut = kEgg;
  cut.trust = (cut.mesh.points.col(2).array() > -6.0).cast<double>();
  for (Index v = 0; v < cut.mesh.n_vertices(); ++v) {
    if (cut.trust[v] == 0.0) cut.mesh.points(v, 2) = -6.0;
  }
  const Points points = register_surface(kEgg, cut, kQuick);
  EXPECT_LT((points - kEgg.mesh.points).rowwise().norm().maxCoeff(), 1.0);
}

TEST(Registration, BringsBordersToBorders) {
  const auto sheet = [](double angle) {
    const TriMesh shell = test::cap(12.0, 1.0, angle);
    TrustedSurface open;
    open.mesh.triangles = shell.triangles.topRows(shell.n_triangles() / 2);
    open.mesh.points = shell.points.topRows(open.mesh.triangles.maxCoeff() + 1);
    return open;
  };
  const TrustedSurface small = sheet(0.9), large = sheet(1.2);
  const Points points = register_surface(small, large, kQuick);
  double lowest = kInfinity;
  for (Index v = 0; v < points.rows(); ++v) lowest = std::min(lowest, points(v, 2));
  EXPECT_NEAR(lowest, 12.0 * std::cos(1.2), 0.3);
}

TEST(Registration, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] { return register_surface(kBall, kEgg, kQuick); };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

TEST(Registration, RefusesOptionsOutOfRange) {
  EXPECT_THROW(register_surface(kBall, kEgg, {.similarity_iterations = -1}), Error);
  EXPECT_THROW(register_surface(kBall, kEgg, {.lengths = {0.0}}), Error);
  EXPECT_THROW(register_surface(kBall, kEgg, {.iterations = 0}), Error);
  EXPECT_THROW(register_surface(kBall, kEgg, {.normal_limit = 1.0}), Error);
  EXPECT_THROW(register_surface(kBall, kEgg, {.largest_distance = 0.0}), Error);
  EXPECT_THROW(register_surface({}, kEgg), Error);
}

}  // namespace
}  // namespace coxa::shape
