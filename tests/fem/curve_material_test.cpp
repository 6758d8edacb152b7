#include <coxa/fem/curve_material.h>

#include <coxa/core/error.h>
#include <coxa/fem/elastic_force.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

const Lame kCartilage = lame_from(12.0, 0.42);

Curve toe(double scale) {
  return Curve({-0.5, 0.0, 0.2, 0.5}, {-3.0 * scale, 0.0, 0.4 * scale, 3.0 * scale});
}
// no two directions alike, with a resistance to the sum of the tensile strains and to one odd
// combination
std::unique_ptr<Material> anisotropic() {
  auto modes = six_modes({toe(1), toe(2), toe(5), toe(0.5), toe(0.8), toe(1.3)});
  modes.push_back(volume_mode(Curve::line(20.0)));
  modes.push_back({(Vec6() << 1, -0.5, 0, 0, 0.7, 0).finished(), toe(2)});
  return make_curve_material(modes);
}

TEST(CurveMaterial, WithStraightCurvesIsStVenantKirchhoff) {
  const auto curves = make_curve_material(linear_modes(kCartilage));
  const auto law = make_st_venant_kirchhoff(kCartilage);
  Rng rng(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Mat3 F = Mat3::Identity() + 0.2 * test::random_matrix(rng);
    EXPECT_NEAR(curves->energy_density(F), law->energy_density(F), 1e-11);
    EXPECT_LE((curves->first_piola(F) - law->first_piola(F)).norm(), 1e-11);
    EXPECT_LE((curves->tangent(F, Tangent::exact) - law->tangent(F, Tangent::exact)).norm(), 1e-10);
  }
}
TEST(CurveMaterial, HasTheStressOfItsEnergyAndTheTangentOfItsStress) {
  const auto law = anisotropic();
  constexpr double h = 1e-6;
  Rng rng(2);
  for (int trial = 0; trial < 10; ++trial) {
    const Mat3 F = Mat3::Identity() + 0.2 * test::random_matrix(rng);
    const Mat3 P = law->first_piola(F);
    const Mat9 C = law->tangent(F, Tangent::exact);
    for (int k = 0; k < 9; ++k) {
      Mat3 above = F, below = F;
      above(k) += h;
      below(k) -= h;
      EXPECT_NEAR(P(k), (law->energy_density(above) - law->energy_density(below)) / (2 * h), 1e-6);
      const Mat3 dP = (law->first_piola(above) - law->first_piola(below)) / (2 * h);
      EXPECT_LE((C.col(k) - dP.reshaped()).norm(), 1e-4 * C.norm());
    }
  }
}
TEST(CurveMaterial, OffersAPositiveTangent) {
  const auto law = anisotropic();
  const Mat3 F = Vec3(0.7, 0.6, 0.8).asDiagonal();
  const auto lowest = [&](Tangent kind) {
    return Eigen::SelfAdjointEigenSolver<Mat9>(law->tangent(F, kind)).eigenvalues()[0];
  };
  EXPECT_LT(lowest(Tangent::exact), -0.1);
  EXPECT_GE(lowest(Tangent::positive), -1e-12);
}
TEST(CurveMaterial, FollowsTheAxesOfItsElements) {
  // stretching along the material's w axis meets curve 5, whichever way w points
  TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const Mat3 axes = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).matrix();
  const ElasticForce turned(
      mesh, make_curve_material(six_modes({toe(1), toe(2), toe(5), toe(1), toe(1), toe(1)})), {},
      {.axes = std::vector<Mat3>(6, axes), .tangent = Tangent::exact});
  const double l = 1.3, e = 0.5 * (l * l - 1.0);
  const Mat3 F = Mat3::Identity() + (l - 1.0) * axes.col(2) * axes.col(2).transpose();
  const VecX x = test::stacked(mesh.points * F.transpose());
  EXPECT_LE(
      (turned.cauchy_stress(x, 0) - l * toe(5).value(e) * axes.col(2) * axes.col(2).transpose())
          .norm(),
      1e-12);
  EXPECT_LE((turned.deformation_gradient(x, 2) - F).norm(), 1e-13);
  Rng rng(3);
  VecX shaken = x;
  for (double& value : shaken) value += 0.05 * rng.normal();
  const VecX v = VecX::Zero(x.size());
  EXPECT_LE(
      (dynamics::test::force_at(turned, shaken, v) - dynamics::test::numeric_force(turned, shaken))
          .norm(),
      1e-7);
  EXPECT_LE((dynamics::test::given_stiffness(turned, shaken, v) -
             dynamics::test::numeric_stiffness(turned, shaken, v))
                .norm(),
            1e-4);
}
TEST(CurveMaterial, NeedsAMode) { EXPECT_THROW(make_curve_material({}), Error); }

TEST(RotatedCurveMaterial, WithStraightCurvesIsCorotational) {
  const auto curves =
      make_rotated_curve_material(Curve::line(2.0 * kCartilage.mu), Curve::line(kCartilage.lambda));
  const auto law = make_corotational(kCartilage);
  Rng rng(4);
  for (int trial = 0; trial < 10; ++trial) {
    const Mat3 F = Mat3::Identity() + 0.3 * test::random_matrix(rng);
    EXPECT_NEAR(curves->energy_density(F), law->energy_density(F), 1e-11);
    EXPECT_LE((curves->first_piola(F) - law->first_piola(F)).norm(), 1e-10);
    EXPECT_LE((curves->tangent(F, Tangent::positive) - law->tangent(F, Tangent::positive)).norm(),
              1e-9);
  }
}
TEST(RotatedCurveMaterial, FollowsItsCurveUnderStrongCompressionAndInversion) {
  const auto law = make_rotated_curve_material(toe(1), Curve::line(0.0));
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(0, 1, 1).normalized()).matrix();
  for (const double l : {0.9, 0.5, 0.1, -0.2}) {
    const Mat3 P = law->first_piola(R * Vec3(1, 1, l).asDiagonal());
    EXPECT_LE((P - R * Vec3(0, 0, toe(1).value(l - 1.0)).asDiagonal()).norm(), 1e-12) << l;
  }
}

}  // namespace coxa::fem
