#include <coxa/segment/mesh_forces.h>

#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

VecX flat(const Points& p) { return Eigen::Map<const VecX>(p.data(), p.size()); }

MatX dense(const solve::BlockMatrix& A) {
  MatX m = MatX::Zero(3 * A.n(), 3 * A.n());
  for (Index r = 0; r < A.n(); ++r)
    for (std::int64_t s = A.row_start()[r]; s < A.row_start()[r + 1]; ++s)
      m.block<3, 3>(3 * r, 3 * A.columns()[s]) = A.blocks()[s];
  return m;
}

/// Force = -dE/dx and Jacobian = -df/dx by central differences, exact for the quadratic energies
/// here.
void expect_consistent(const dynamics::Force& force, const VecX& x) {
  const VecX v = VecX::Zero(x.size());
  VecX f = VecX::Zero(x.size());
  force.add_force(x, v, f);
  solve::BlockMatrix A(static_cast<Index>(x.size() / 3), force.pattern());
  force.add_jacobian(x, v, 1.0, 0.0, A);
  const MatX K = dense(A);
  const double h = 1e-3;
  for (Eigen::Index i = 0; i < x.size(); i += 7) {
    VecX up = x, down = x;
    up[i] += h;
    down[i] -= h;
    EXPECT_NEAR(f[i], -(force.energy(up) - force.energy(down)) / (2 * h), 1e-6);
    VecX f_up = VecX::Zero(x.size()), f_down = f_up;
    force.add_force(up, v, f_up);
    force.add_force(down, v, f_down);
    EXPECT_LE((K.col(i) + (f_up - f_down) / (2 * h)).cwiseAbs().maxCoeff(), 1e-8);
  }
  EXPECT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12);
}

struct Parts {
  SimplexMesh mesh = make_simplex_mesh(toy::egg_surface({}, 1));
  Points metric{mesh.n_vertices(), 3}, offsets{mesh.n_vertices(), 3};
  Parts() {
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const Vec3 A = mesh.points.row(mesh.neighbours(v, 0)),
                 B = mesh.points.row(mesh.neighbours(v, 1)),
                 C = mesh.points.row(mesh.neighbours(v, 2)), P = mesh.points.row(v);
      const SimplexParameters form = simplex_parameters(P, A, B, C);
      metric.row(v) = form.metric;
      offsets.row(v) = P - form.metric[0] * A - form.metric[1] * B - form.metric[2] * C;
    }
  }
};

}  // namespace

TEST(SimplexForce, IsTheGradientOfItsEnergyAndItsJacobianIsExact) {
  const Parts parts;
  SimplexForce force(0, parts.mesh.neighbours);
  force.prepare(parts.metric, parts.offsets, 0.7);
  Rng rng(1);
  VecX x = flat(parts.mesh.points);
  for (double& value : x) value += rng.normal();
  expect_consistent(force, x);
}

TEST(SimplexForce, VanishesForTheFormItRemembersAndForNoOther) {
  const Parts parts;
  SimplexForce force(0, parts.mesh.neighbours);
  force.prepare(parts.metric, parts.offsets, 1.0);
  VecX x = flat(parts.mesh.points), f = VecX::Zero(x.size());
  EXPECT_NEAR(force.energy(x), 0.0, 1e-18);
  x[4] += 1.0;
  force.add_force(x, f, f);
  EXPECT_LT(f[4], -0.5);
}

TEST(TargetForce, IsTheGradientOfItsEnergyAndItsJacobianIsExact) {
  const Parts parts;
  TargetForce force(0);
  Rng rng(2);
  Points targets = parts.mesh.points, normals = simplex_normals(parts.mesh);
  for (Index v = 0; v < targets.rows(); ++v) targets.row(v) += rng.normal3().transpose();
  force.prepare(targets, VecX::Constant(targets.rows(), 2.0), normals, 0.25);
  expect_consistent(force, flat(parts.mesh.points));
}

TEST(TargetForce, ActsAcrossTheNormalByTheTangentialShare) {
  TargetForce force(1);
  Points target(1, 3), normal(1, 3);
  target << 1.0, 0.0, 1.0;
  normal << 0.0, 0.0, 1.0;
  force.prepare(target, VecX::Constant(1, 2.0), normal, 0.25);
  VecX x = VecX::Zero(6), f = VecX::Zero(6);
  force.add_force(x, x, f);
  EXPECT_NEAR(f[3], 0.5, 1e-15);
  EXPECT_NEAR(f[5], 2.0, 1e-15);
  EXPECT_EQ(f.head(3).norm(), 0.0);
}

TEST(PositionFromAngle, ReproducesVerticesFromTheirOwnAngle) {
  Rng rng(3);
  int checked = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 A = rng.normal3(), B = rng.normal3(), C = rng.normal3(), P = rng.normal3();
    const SimplexParameters form = simplex_parameters(P, A, B, C);
    const Vec3 foot = form.metric[0] * A + form.metric[1] * B + form.metric[2] * C;
    const Vec3 n = (B - A).cross(C - A).normalized();
    const double phi = simplex_angle(P, A, B, C);
    const Vec3 again = position_from_angle(form.metric, phi, (P - foot).dot(n), A, B, C);
    EXPECT_LE((again - P).norm(), 1e-6 * (1.0 + P.norm())) << "phi " << phi;
    ++checked;
  }
  EXPECT_EQ(checked, 500);
}

TEST(PositionFromAngle, LiesInThePlaneForAFlatAngle) {
  const Vec3 A(1, 0, 0), B(0, 1, 0), C(-1, -1, 0);
  EXPECT_NEAR(position_from_angle(Vec3::Constant(1.0 / 3.0), 0.0, 5.0, A, B, C).z(), 0.0, 1e-15);
}

}  // namespace coxa::segment
