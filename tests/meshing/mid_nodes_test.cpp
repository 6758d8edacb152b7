#include "meshing/mid_nodes.h"

#include <coxa/core/rng.h>
#include <coxa/mesh/measures.h>
#include <coxa/meshing/mesh_surface.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <Eigen/Geometry>

#include <cmath>
#include <set>

namespace coxa::meshing {
namespace {

// by the shape functions' own sum, independent of the polynomial's coefficients
double determinant_at(const TenNodes& n, double r, double s, double t) {
  const auto position = [&](double a, double b, double c) {
    const double l[4] = {1.0 - a - b - c, a, b, c};
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) p += l[k] * (2.0 * l[k] - 1.0) * n[k];
    return Vec3(p + 4.0 * (l[0] * l[1] * n[4] + l[1] * l[2] * n[5] + l[2] * l[0] * n[6] +
                           l[0] * l[3] * n[7] + l[1] * l[3] * n[8] + l[2] * l[3] * n[9]));
  };
  constexpr double h = 1e-4;  // central differences of a quadratic are exact but for rounding
  Mat3 J;
  J.col(0) = (position(r + h, s, t) - position(r - h, s, t)) / (2 * h);
  J.col(1) = (position(r, s + h, t) - position(r, s - h, t)) / (2 * h);
  J.col(2) = (position(r, s, t + h) - position(r, s, t - h)) / (2 * h);
  return J.determinant();
}

Vec3 place_in(Rng& rng) {
  for (;;) {
    const Vec3 p(rng.uniform(), rng.uniform(), rng.uniform());
    if (p.sum() <= 1.0) return p;
  }
}

// exact for the cubic determinant (Keast's five points)
double volume_of(const TenNodes& n) {
  double sum = -0.8 * determinant_at(n, 0.25, 0.25, 0.25);
  for (int k = 0; k < 4; ++k) {
    Vec3 p = Vec3::Constant(1.0 / 6.0);
    if (k < 3) p[k] = 0.5;
    sum += 0.45 * determinant_at(n, p[0], p[1], p[2]);
  }
  return sum / 6.0;
}

TEST(MidNodes, BoundTheDeterminantFromBothSides) {
  Rng rng(4);
  for (int trial = 0; trial < 100; ++trial) {
    TenNodes n{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    constexpr std::size_t kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    for (std::size_t e = 0; e < 6; ++e)
      n[4 + e] = 0.5 * (n[kEdges[e][0]] + n[kEdges[e][1]]) + 0.15 * rng.normal3();
    const JacobianBounds bounds = jacobian_bounds(n);
    for (int k = 0; k < 50; ++k) {
      const Vec3 p = place_in(rng);
      const double J = determinant_at(n, p[0], p[1], p[2]);
      EXPECT_GE(J, bounds.least - 1e-6);
      EXPECT_LE(J, bounds.largest + 1e-6);
    }
  }
}

TEST(MidNodes, AreExactForStraightElements) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 3, 0), d(0, 0, 4);
  const TenNodes n{a,           b,           c,           d,           (a + b) / 2,
                   (b + c) / 2, (a + c) / 2, (a + d) / 2, (b + d) / 2, (c + d) / 2};
  EXPECT_NEAR(jacobian_bounds(n).least, 24.0, 1e-9);
  EXPECT_NEAR(jacobian_bounds(n).largest, 24.0, 1e-9);
}

TEST(MidNodes, LieOnTheSurfaceAndMakeABallRound) {
  const TriMesh ball = coxa::test::icosphere(4, 10.0);
  const TetMesh straight = mesh_surface(ball, {.max_tets = 2000}).mesh;
  const MeshingResult made =
      mesh_surface(ball, {.max_tets = 2000, .order = ElementOrder::ten_node});
  const TetMesh& mesh = made.mesh;
  EXPECT_EQ(mesh.tets, straight.tets);
  EXPECT_EQ(mesh.facets, straight.facets);
  ASSERT_EQ(mesh.mid_nodes.rows(), mesh.tets.rows());
  std::set<Index> used(mesh.mid_nodes.data(), mesh.mid_nodes.data() + mesh.mid_nodes.size());
  EXPECT_EQ(static_cast<Index>(used.size()), mesh.n_vertices() - straight.n_vertices());
  Rng rng(1);
  double curved = 0.0, flat = 0.0;
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    const TenNodes n = ten_nodes(mesh, t);
    curved += volume_of(n);
    flat += (n[1] - n[0]).cross(n[2] - n[0]).dot(n[3] - n[0]) / 6.0;
    for (int k = 0; k < 5; ++k) {
      const Vec3 p = place_in(rng);
      ASSERT_GT(determinant_at(n, p[0], p[1], p[2]), 0.0);
    }
  }
  EXPECT_LT(std::abs(curved - volume(ball)), 0.2 * std::abs(flat - volume(ball)));
  EXPECT_GE(made.report.least_jacobian, 0.2);
}

TEST(MidNodes, AreDrawnBackWhereTheyWouldInvertAnElement) {
  // one flat element whose face lies far below a surface
  TetMesh mesh;
  mesh.points.resize(4, 3);
  mesh.points << 0, 0, 0, 1, 0, 0, 0.5, 0.9, 0, 0.5, 0.3, 0.1;
  mesh.tets.resize(1, 4);
  mesh.tets << 0, 1, 2, 3;
  mesh.facets.resize(1, 3);
  mesh.facets << 0, 2, 1;
  mesh.facet_tags = {FacetTag::untagged};
  const TriMesh above = coxa::test::plate(0.15);
  const MidNodeReport report =
      update_to_ten_nodes(mesh, TriangleTree(above.points, above.triangles));
  EXPECT_EQ(report.n_curved, 3);
  EXPECT_EQ(report.n_relaxed, 3);
  EXPECT_GE(report.least_ratio, 0.2);
  EXPECT_GT(jacobian_bounds(ten_nodes(mesh, 0)).least, 0.0);
}

}  // namespace
}  // namespace coxa::meshing
