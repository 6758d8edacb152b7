#include <coxa/mesh/simplex_mesh.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <Eigen/Dense>

#include <cmath>

namespace coxa {

TEST(SimplexMesh, CountsFollowEuler) {
  for (const auto& [mesh, handles] : {std::pair{test::icosphere(2), 0}, {test::torus(), 1}}) {
    const SimplexMesh simplex = make_simplex_mesh(mesh);
    EXPECT_EQ(simplex.n_vertices(), mesh.n_triangles());
    EXPECT_EQ(simplex.n_faces, simplex.n_vertices() / 2 + 2 - 2 * handles);
  }
}
TEST(SimplexMesh, NeighboursAreMutualAndShareTheirTwoFaces) {
  const SimplexMesh mesh = make_simplex_mesh(test::lunate_shell());
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 3; ++k) {
      const Index other = mesh.neighbours(v, k);
      ASSERT_TRUE((mesh.neighbours.row(other).array() == v).any());
      for (int j : {k, (k + 1) % 3})
        ASSERT_TRUE((mesh.faces_of.row(other).array() == mesh.faces_of(v, j)).any());
    }
}
TEST(SimplexMesh, NormalsPointOutward) {
  const SimplexMesh mesh = make_simplex_mesh(test::icosphere(3));
  const Points normals = simplex_normals(mesh);
  EXPECT_GT((normals.cwiseProduct(mesh.points.rowwise().normalized())).rowwise().sum().minCoeff(),
            0.99);
}
TEST(SimplexMesh, RefusesOpenSurfaces) { EXPECT_THROW(make_simplex_mesh(test::plate(0.0)), Error); }

TEST(FanSurface, IsClosedOutwardAndKeepsTheSimplexVertices) {
  const SimplexMesh mesh = make_simplex_mesh(test::torus());
  const TriMesh fan = fan_surface(mesh);
  EXPECT_EQ(manifold_fault(fan), "");
  EXPECT_EQ(genus(fan), 1);
  EXPECT_GT(volume(fan), 0.0);
  EXPECT_EQ(fan.points.topRows(mesh.n_vertices()), mesh.points);
}
TEST(DualSurface, PutsTriangleCentroidsOnTheSimplexVertices) {
  const SimplexMesh mesh = make_simplex_mesh(test::lunate_shell());
  const SimplexMesh again = make_simplex_mesh(dual_surface(mesh));
  EXPECT_LE((again.points - mesh.points).rowwise().norm().maxCoeff(), 2e-3);
  EXPECT_EQ(again.neighbours, mesh.neighbours);
}
TEST(DualSurface, DoesNotShrinkOverManyConversions) {
  const TriMesh sphere = test::icosphere(3);
  TriMesh surface = sphere;
  for (int round = 0; round < 10; ++round) surface = dual_surface(make_simplex_mesh(surface));
  EXPECT_LE((surface.points - sphere.points).rowwise().norm().maxCoeff(), 5e-3);
  EXPECT_NEAR(volume(surface), volume(sphere), 1e-3 * volume(sphere));
}

struct Star {
  Vec3 P, A, B, C;
};
Star random_star(Rng& rng) { return {rng.normal3(), rng.normal3(), rng.normal3(), rng.normal3()}; }

TEST(SimplexParameters, DescribeThePosition) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const auto [P, A, B, C] = random_star(rng);
    const SimplexParameters parameters = simplex_parameters(P, A, B, C);
    ASSERT_NEAR(parameters.metric.sum(), 1.0, 1e-12);
    ASSERT_LE((position_from(parameters, A, B, C) - P).norm(), 1e-9);
  }
}
TEST(SimplexParameters, AreUnchangedBySimilarities) {
  Rng rng(2);
  const RigidTransform X = test::some_pose();
  for (int i = 0; i < 100; ++i) {
    const auto [P, A, B, C] = random_star(rng);
    const SimplexParameters p = simplex_parameters(P, A, B, C);
    const SimplexParameters q =
        simplex_parameters(X * (2.5 * P), X * (2.5 * A), X * (2.5 * B), X * (2.5 * C));
    ASSERT_LE((p.metric - q.metric).norm() + std::abs(p.height - q.height),
              1e-9 * (1 + p.metric.norm()));
  }
}
TEST(SimplexParameters, AreTheCentroidAndNoHeightWhereNeighboursLieInALine) {
  const Vec3 A(0, 0, 0), B(1, 0, 0), C(2, 0, 0);
  const SimplexParameters parameters = simplex_parameters(Vec3(1, 5, 0), A, B, C);
  EXPECT_EQ(parameters.height, 0.0);
  EXPECT_LE((position_from(parameters, A, B, C) - B).norm(), 1e-15);
}
TEST(SimplexAngle, HasTheSineAndCosineOfItsDefinition) {
  // sin phi = s r / R and cos phi = -s c / R with the circumscribed sphere found by solving for its
  // centre
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const auto [P, A, B, C] = random_star(rng);
    Mat3 rows;
    rows << (A - P).transpose(), (B - P).transpose(), (C - P).transpose();
    const Vec3 half(0.5 * (A - P).squaredNorm(), 0.5 * (B - P).squaredNorm(),
                    0.5 * (C - P).squaredNorm());
    const Vec3 O = P + rows.partialPivLu().solve(half);
    const double R = (O - P).norm();
    const Vec3 n = (B - A).cross(C - A).normalized();
    const double c = (O - A).dot(n);
    const double r = std::sqrt(R * R - c * c), s = (P - A).dot(n) > 0 ? 1.0 : -1.0;
    const double phi = simplex_angle(P, A, B, C);
    ASSERT_NEAR(std::sin(phi), s * r / R, 1e-6);
    ASSERT_NEAR(std::cos(phi), -s * c / R, 1e-6);
  }
}
TEST(SimplexAngle, GivesTheMeanCurvatureOfASphere) {
  // any vertex and neighbours on a sphere: sin(phi) / r = 1 / radius
  const SimplexMesh raw = make_simplex_mesh(test::icosphere(3));
  SimplexMesh mesh = raw;
  mesh.points = 10.0 * raw.points.rowwise().normalized();
  for (Index v = 0; v < mesh.n_vertices(); v += 7) {
    const Vec3 P = mesh.points.row(v), A = mesh.points.row(mesh.neighbours(v, 0)),
               B = mesh.points.row(mesh.neighbours(v, 1)),
               C = mesh.points.row(mesh.neighbours(v, 2));
    const double r =
        (B - C).norm() * (C - A).norm() * (A - B).norm() / (2.0 * (B - A).cross(C - A).norm());
    ASSERT_NEAR(std::sin(simplex_angle(P, A, B, C)) / r, 0.1, 1e-8);
  }
}
TEST(SimplexAngle, IsPositiveWhereConvexZeroWhenFlatNegativeWhereConcave) {
  const Vec3 A(1, 0, 0), B(-0.5, 0.9, 0), C(-0.5, -0.9, 0);
  EXPECT_GT(simplex_angle(Vec3(0, 0, 0.3), A, B, C), 0.0);
  EXPECT_EQ(simplex_angle(Vec3(0, 0, 0), A, B, C), 0.0);
  EXPECT_EQ(simplex_angle(Vec3(0, 0, -0.3), A, B, C), -simplex_angle(Vec3(0, 0, 0.3), A, B, C));
  EXPECT_GT(simplex_angle(Vec3(0, 0, 9.0), A, B, C), 0.9 * kPi);
}

}  // namespace coxa
