#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/fem/results.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "fem/shapes.h"

namespace coxa::fem {

TEST(Results, GiveStrainAndStressOfAStretchedBar) {
  const TetMesh mesh = test::block(2, 1, 1, Vec3::Ones());
  const double E = 12.0, nu = 0.42, l = 1.1, lateral = std::sqrt(1.0 - nu * (l * l - 1.0));
  const ElasticForce force(mesh, make_st_venant_kirchhoff(lame_from(E, nu)));
  // stretched along x, then turned about z: stresses turn with it
  const Mat3 R = Eigen::AngleAxisd(0.5, Vec3::UnitZ()).matrix();
  const Mat3 F = R * Vec3(l, lateral, lateral).asDiagonal();
  const ElementFields fields = compute_fields(force, test::stacked(mesh.points * F.transpose()));
  const double sigma = 0.5 * E * l * (l * l - 1.0) / (lateral * lateral);
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    EXPECT_LE((fields.deformation_gradient[at] - F).norm(), 1e-13);
    EXPECT_LE((fields.cauchy_stress[at] - sigma * R.col(0) * R.col(0).transpose()).norm(), 1e-11);
    EXPECT_NEAR(fields.green_strain[at](0, 0), 0.5 * (l * l - 1.0), 1e-12);
    EXPECT_NEAR(fields.principal_stress(e, 0), sigma, 1e-11);
    EXPECT_NEAR(fields.principal_stress(e, 2), 0.0, 1e-11);
    EXPECT_NEAR(fields.principal_strain(e, 0), 0.5 * (l * l - 1.0), 1e-12);
    EXPECT_NEAR(fields.von_mises[e], sigma, 1e-11);
    EXPECT_NEAR(fields.volume_ratio[e], l * lateral * lateral, 1e-12);
  }
}
TEST(Results, VonMisesOfPureShearIsRootThreeTimesTheShear) {
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = shear(1, 0) = 2.0;
  EXPECT_NEAR(von_mises_stress(shear), 2.0 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(von_mises_stress(5.0 * Mat3::Identity()), 0.0, 1e-14);
  EXPECT_LE((principal_values(shear) - Vec3(2, 0, -2)).norm(), 1e-14);
}
TEST(Results, RecoverAConstantAndWeighByVolume) {
  TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  mesh.points.conservativeResize(9, 3);
  mesh.points.row(8).setConstant(5.0);  // belongs to no element
  const VecX volumes = VecX::LinSpaced(6, 1.0, 6.0);
  const MatX constant = recover_to_nodes(mesh, volumes, MatX::Constant(6, 2, 3.0));
  EXPECT_LE((constant.topRows(8).array() - 3.0).abs().maxCoeff(), 1e-14);
  EXPECT_TRUE(constant.row(8).array().isNaN().all());
  // node 0 belongs to all six elements: sum k^2 / sum k
  EXPECT_NEAR(recover_to_nodes(mesh, volumes, volumes)(0, 0), 91.0 / 21.0, 1e-13);
  EXPECT_THROW(recover_to_nodes(mesh, volumes, MatX::Zero(5, 1)), Error);
}
TEST(Results, AreBitIdenticalForOneAndEightThreads) {
  const TetMesh mesh = test::shaken(test::block(4, 4, 2, Vec3::Ones()), 0.1);
  const ElasticForce force(mesh, make_corotational(lame_from(12, 0.42)));
  const VecX x = 1.1 * test::stacked(mesh.points);
  const auto run = [&] { return compute_fields(force, x).von_mises; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

}  // namespace coxa::fem
