#include <coxa/dynamics/forces.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <gtest/gtest.h>

#include "dynamics/witness.h"

namespace coxa::dynamics {

VecX random_values(Eigen::Index size, std::uint64_t seed) {
  Rng rng(seed);
  VecX values(size);
  for (double& value : values) value = rng.normal();
  return values;
}

TEST(SpringForce, IsMinusTheGradientOfItsEnergyWithItsJacobian) {
  const SpringForce springs({{.a = 0, .b = 1, .rest_length = 0.4, .stiffness = 3.0},
                             {.a = 2, .b = 1, .rest_length = 9.0, .stiffness = 2.0}});
  const VecX x = random_values(9, 1), rest = VecX::Zero(9);
  EXPECT_LE((test::force_at(springs, x, rest) - test::numeric_force(springs, x)).norm(), 1e-8);
  EXPECT_LE(
      (test::given_stiffness(springs, x, rest) - test::numeric_stiffness(springs, x, rest)).norm(),
      1e-7);
}
TEST(SpringForce, DampsAlongItsLine) {
  const SpringForce damper({{.a = 0, .b = 1, .damping = 2.0}});
  const VecX x = random_values(6, 2), v = random_values(6, 3);
  EXPECT_LE((test::given_damping(damper, x, v) - test::numeric_damping(damper, x, v)).norm(), 1e-8);
  EXPECT_LT(test::force_at(damper, x, v).dot(v), 0.0);
}
TEST(SpringForce, PullsButDoesNotPushInTensionOnlyMode) {
  const SpringForce band(
      {{.a = 0, .b = 1, .rest_length = 2.0, .stiffness = 5.0, .mode = Spring::Mode::tension_only}});
  const VecX slack = (VecX(6) << 0, 0, 0, 1.9, 0, 0).finished();
  const VecX taut = (VecX(6) << 0, 0, 0, 2.1, 0, 0).finished();
  EXPECT_EQ(band.tension(0, slack), 0.0);
  EXPECT_EQ(band.energy(slack), 0.0);
  EXPECT_EQ(test::force_at(band, slack, VecX::Zero(6)), VecX::Zero(6));
  EXPECT_NEAR(band.tension(0, taut), 0.5, 1e-14);
  EXPECT_NEAR(test::force_at(band, taut, VecX::Zero(6))[0], 0.5, 1e-14);
}
TEST(SpringForce, RejectsALoopAndNegativeValues) {
  EXPECT_THROW(SpringForce({{.a = 1, .b = 1}}), Error);
  EXPECT_THROW(SpringForce({{.a = 0, .b = 1, .stiffness = -1.0}}), Error);
}
TEST(ConstantForce, HasTheEnergyOfALoad) {
  const ConstantForce load(random_values(6, 4));
  const VecX x = random_values(6, 5);
  EXPECT_LE((test::force_at(load, x, x) - test::numeric_force(load, x)).norm(), 1e-8);
}
TEST(MassDamping, SlowsEachParticleByItsMass) {
  const MassDamping damping(Vec2(1.0, 3.0), 0.5);
  const VecX v = random_values(6, 6), x = VecX::Zero(6);
  EXPECT_LE((test::force_at(damping, x, v).tail<3>() + 1.5 * v.tail<3>()).norm(), 1e-14);
  EXPECT_LE((test::given_damping(damping, x, v) - test::numeric_damping(damping, x, v)).norm(),
            1e-9);
  EXPECT_THROW(MassDamping(Vec2(1, 1), -1.0), Error);
}

}  // namespace coxa::dynamics
