#include <coxa/dynamics/particles.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

namespace coxa::dynamics {

TEST(Constraints, FilterProjectsOnlyTheirParticles) {
  Constraints constraints;
  constraints.add(2, Mat3::Identity() - Vec3::UnitX() * Vec3::UnitX().transpose(), Vec3::Zero());
  constraints.hold(0);
  VecX values = VecX::Ones(9);
  constraints.filter(values);
  EXPECT_EQ(values, (VecX(9) << 0, 0, 0, 1, 1, 1, 0, 1, 1).finished());
}
TEST(Constraints, StayInAscendingOrderAndTheLastOneOfAParticleHolds) {
  Constraints constraints;
  constraints.hold(5);
  constraints.hold(1);
  constraints.add(5, Mat3::Identity(), Vec3(1, 2, 3));
  EXPECT_EQ(constraints.particles, (std::vector<Index>{1, 5}));
  EXPECT_EQ(constraints.allowed[1], Mat3::Identity());
  EXPECT_EQ(constraints.velocity_change[1], Vec3(1, 2, 3));
}
TEST(Constraints, RejectsANegativeParticle) {
  Constraints constraints;
  EXPECT_THROW(constraints.hold(-1), Error);
}

}  // namespace coxa::dynamics
