#include <coxa/fem/viscous_force.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

// shear-thinning along one axis, straight elsewhere
std::vector<StrainMode> some_modes() {
  const Curve thin({-5, -1, 0, 1, 5}, {-3, -1.5, 0, 1.5, 3});
  auto modes =
      six_modes({thin, Curve::line(2), Curve::line(3), Curve::line(1), thin, Curve::line(1)});
  modes.push_back(volume_mode(Curve::line(4.0)));
  return modes;
}
struct Moving {
  TetMesh mesh = test::shaken(test::block(2, 1, 1, Vec3::Ones()), 0.1);
  ViscousForce force{mesh, some_modes()};
  VecX x = test::stacked(mesh.points), v = VecX::Zero(x.size());
  Moving() {
    Rng rng(5);
    for (double& value : x) value += 0.05 * rng.normal();
    for (double& value : v) value = rng.normal();
  }
};

TEST(ViscousForce, HasTheDampingOfItsForceWhichIsSymmetric) {
  const Moving m;
  const MatX D = dynamics::test::given_damping(m.force, m.x, m.v);
  EXPECT_LE((D - dynamics::test::numeric_damping(m.force, m.x, m.v)).norm(), 1e-6 * D.norm());
  EXPECT_LE((D - D.transpose()).norm(), 1e-12 * D.norm());
}
TEST(ViscousForce, HasTheStiffnessOfAnElementThatTurns) {
  // at a homogeneous rate the geometric part is what is left when the rate does not change with the
  // positions
  const Moving m;
  const MatX K = dynamics::test::given_stiffness(m.force, m.x, m.v);
  EXPECT_LE((K - K.transpose()).norm(), 1e-12 * K.norm());
  // moving all nodes alike changes nothing
  VecX shift(m.x.size());
  for (Eigen::Index i = 0; i < shift.size(); ++i) shift[i] = i % 3 == 0 ? 1.0 : 0.5;
  EXPECT_LE((K * shift).norm(), 1e-12 * K.norm());
}
TEST(ViscousForce, LosesThePowerOfItsForce) {
  const Moving m;
  const double power = dynamics::test::force_at(m.force, m.x, m.v).dot(m.v);
  EXPECT_LT(power, 0.0);
  EXPECT_NEAR(power, -m.force.dissipation(m.x, m.v), 1e-10 * std::abs(power));
}
TEST(ViscousForce, DoesNotResistARigidRotation) {
  const Moving m;
  VecX v(m.x.size());
  const Vec3 omega(1, -2, 0.5);
  for (Index i = 0; i < m.mesh.n_vertices(); ++i)
    v.segment<3>(3 * i) = omega.cross(Vec3(m.x.segment<3>(3 * i)));
  EXPECT_LE(dynamics::test::force_at(m.force, m.x, v).norm(), 1e-12);
}
TEST(ViscousForce, FollowsItsCurveInUniaxialStretching) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const ViscousForce force(mesh, some_modes());
  const double rate = 3.0;
  VecX v = VecX::Zero(24);
  for (Index i = 0; i < 8; ++i) v[3 * i] = rate * mesh.points(i, 0);
  const VecX f = dynamics::test::force_at(force, test::stacked(mesh.points), v);
  double pull = 0.0;
  for (Index i = 0; i < 8; ++i)
    if (mesh.points(i, 0) > 0.5) pull -= f[3 * i];
  EXPECT_NEAR(pull, some_modes()[0].stress.value(rate) + 4.0 * rate, 1e-12);
}
TEST(ViscousForce, FollowsOffsetsAndIsBitIdenticalForOneAndEightThreads) {
  Moving m;
  const VecX before = dynamics::test::force_at(m.force, m.x, m.v);
  m.force.set_offsets(0.1 * m.mesh.points);
  EXPECT_GT((dynamics::test::force_at(m.force, m.x, m.v) - before).norm(), 0.01);
  const auto run = [&] { return dynamics::test::force_at(m.force, m.x, m.v); };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
  EXPECT_THROW(ViscousForce(m.mesh, {}), Error);
}

}  // namespace coxa::fem
