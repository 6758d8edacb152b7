#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::dynamics {

constexpr solve::CgOptions kTight{.tolerance = 1e-13, .max_iterations = 500};

// a mass on a stretched spring, swinging and bouncing about the held particle 0
Particles pendulum() {
  return {(VecX(6) << 0, 0, 0, 1.2, 0.1, 0).finished(),
          (VecX(6) << 0, 0, 0, 0.3, 1.0, -0.2).finished(), Vec2(1.0, 0.7)};
}
SpringForce pendulum_spring(double damping = 0.0) {
  return SpringForce({{.a = 0, .b = 1, .rest_length = 1.0, .stiffness = 20.0, .damping = damping}});
}
Constraints hold_first() {
  Constraints constraints;
  constraints.hold(0);
  return constraints;
}

Particles after_one_second(Integrator integrator, int steps, const Force& force) {
  Particles particles = pendulum();
  Stepper stepper(2, {&force});
  const StepOptions options{.integrator = integrator,
                            .time_step = 1.0 / steps,
                            .newton_iterations = 12,
                            .newton_tolerance = 1e-12,
                            .linear = kTight};
  for (int k = 0; k < steps; ++k) stepper.update_step(particles, hold_first(), options);
  return particles;
}

double observed_order(Integrator integrator, int steps, const Force& force) {
  const Particles reference = after_one_second(Integrator::runge_kutta4, 4000, force);
  const double coarse = (after_one_second(integrator, steps, force).x - reference.x).norm();
  const double fine = (after_one_second(integrator, 2 * steps, force).x - reference.x).norm();
  return std::log2(coarse / fine);
}

TEST(Stepper, HasTheOrderOfEachIntegrator) {
  const SpringForce spring = pendulum_spring();
  EXPECT_NEAR(observed_order(Integrator::backward_euler, 400, spring), 1.0, 0.1);
  EXPECT_NEAR(observed_order(Integrator::implicit_midpoint, 100, spring), 2.0, 0.05);
  EXPECT_NEAR(observed_order(Integrator::bdf2, 200, spring), 2.0, 0.1);
  EXPECT_NEAR(observed_order(Integrator::runge_kutta4, 50, spring), 4.0, 0.1);
}
TEST(Stepper, KeepsItsOrderWithDamping) {
  const SpringForce spring = pendulum_spring(0.8);
  EXPECT_NEAR(observed_order(Integrator::backward_euler, 400, spring), 1.0, 0.1);
  EXPECT_NEAR(observed_order(Integrator::implicit_midpoint, 100, spring), 2.0, 0.1);
  EXPECT_NEAR(observed_order(Integrator::bdf2, 200, spring), 2.0, 0.1);
}

double linearised_order(Integrator integrator, int steps) {
  const SpringForce spring = pendulum_spring();
  const Particles reference = after_one_second(Integrator::runge_kutta4, 4000, spring);
  double error[2];
  for (int level = 0; level < 2; ++level) {
    Particles particles = pendulum();
    Stepper stepper(2, {&spring});
    const int n = steps << level;
    for (int k = 0; k < n; ++k)
      stepper.update_step(particles, hold_first(),
                          {.integrator = integrator, .time_step = 1.0 / n, .linear = kTight});
    error[level] = (particles.x - reference.x).norm();
  }
  return std::log2(error[0] / error[1]);
}
TEST(Stepper, LinearisedStepsKeepTheOrder) {
  EXPECT_NEAR(linearised_order(Integrator::backward_euler, 400), 1.0, 0.1);
  EXPECT_NEAR(linearised_order(Integrator::implicit_midpoint, 200), 2.0, 0.1);
  EXPECT_NEAR(linearised_order(Integrator::bdf2, 400), 2.0, 0.1);
}
TEST(Stepper, Bdf2KeepsItsOrderWhenTheTimeStepChanges) {
  const SpringForce spring = pendulum_spring();
  const Particles reference = after_one_second(Integrator::runge_kutta4, 4000, spring);
  double error[2];
  for (int level = 0; level < 2; ++level) {
    Particles particles = pendulum();
    Stepper stepper(2, {&spring});
    const int pairs = 200 << level;  // each of a short and a long step
    for (int k = 0; k < 2 * pairs; ++k)
      stepper.update_step(particles, hold_first(),
                          {.integrator = Integrator::bdf2,
                           .time_step = (k % 2 == 0 ? 0.4 : 0.6) / pairs,
                           .newton_iterations = 8,
                           .newton_tolerance = 1e-12,
                           .linear = kTight});
    error[level] = (particles.x - reference.x).norm();
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1);
}

// a chain along x between two held ends; its lowest longitudinal mode has a closed form
Particles chain(Index n) {
  Particles particles{VecX::Zero(3 * n), VecX::Zero(3 * n), VecX::Constant(n, 2.0)};
  for (Index i = 0; i < n; ++i) particles.x[3 * i] = i;
  return particles;
}
SpringForce chain_springs(Index n) {
  std::vector<Spring> springs;
  for (Index i = 0; i + 1 < n; ++i)
    springs.push_back({.a = i, .b = i + 1, .rest_length = 1.0, .stiffness = 50.0});
  return SpringForce(springs);
}
Constraints hold_ends(Index n) {
  Constraints constraints;
  constraints.hold(0);
  constraints.hold(n - 1);
  return constraints;
}

TEST(Stepper, GivesTheFrequencyOfFreeVibration) {
  const Index n = 11;
  const SpringForce springs = chain_springs(n);
  Particles particles = chain(n);
  for (Index i = 0; i < n; ++i) particles.x[3 * i] += 1e-3 * std::sin(kPi * i / (n - 1));
  const double omega = 2.0 * std::sqrt(50.0 / 2.0) * std::sin(0.5 * kPi / (n - 1));
  const double quarter = 0.5 * kPi / omega;
  Stepper stepper(n, {&springs});
  const int steps = 2000;
  for (int k = 0; k < steps; ++k)
    stepper.update_step(particles, hold_ends(n),
                        {.integrator = Integrator::implicit_midpoint,
                         .time_step = quarter / steps,
                         .newton_iterations = 3,
                         .linear = kTight});
  // after a quarter of the period the chain passes through rest; the midpoint rule's phase error is
  // far below
  EXPECT_NEAR((particles.x[15] - 5.0) / 1e-3, 0.0, 1e-6);
  EXPECT_NEAR(particles.v[15] / (-1e-3 * omega), 1.0, 1e-6);
}

double energy_ratio_after(Integrator integrator, int steps, double h) {
  const Index n = 6;
  const SpringForce springs = chain_springs(n);
  Particles particles = chain(n);
  particles.x[6] += 0.01;
  const auto energy = [&] { return springs.energy(particles.x) + kinetic_energy(particles); };
  const double start = energy();
  Stepper stepper(n, {&springs});
  for (int k = 0; k < steps; ++k)
    stepper.update_step(
        particles, hold_ends(n),
        {.integrator = integrator, .time_step = h, .newton_iterations = 8, .linear = kTight});
  return energy() / start;
}
TEST(Stepper, MidpointKeepsTheEnergyOfLinearSpringsAndEulerLosesIt) {
  // along the chain's line the springs are linear
  EXPECT_NEAR(energy_ratio_after(Integrator::implicit_midpoint, 500, 0.05), 1.0, 1e-8);
  EXPECT_LT(energy_ratio_after(Integrator::backward_euler, 500, 0.05), 0.1);
  const double bdf2 = energy_ratio_after(Integrator::bdf2, 500, 0.05);
  EXPECT_LT(bdf2, 1.0);
  EXPECT_GT(bdf2, energy_ratio_after(Integrator::backward_euler, 500, 0.05));
}
TEST(Stepper, HoldsAParticleExactlyAndMovesAnotherAsPrescribed) {
  const SpringForce springs = chain_springs(4);
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint,
                                      Integrator::bdf2, Integrator::runge_kutta4}) {
    Particles particles = chain(4);
    particles.x[4] += 0.2;
    Stepper stepper(4, {&springs});
    Constraints constraints;
    constraints.hold(0);
    // particle 3 is brought to 1 mm/s along y at once, and kept there
    constraints.add(3, Mat3::Zero(), Vec3(0, 1, 0));
    stepper.update_step(particles, constraints, {.integrator = integrator, .time_step = 0.01});
    constraints.add(3, Mat3::Zero(), Vec3::Zero());
    for (int k = 0; k < 10; ++k)
      stepper.update_step(particles, constraints, {.integrator = integrator, .time_step = 0.01});
    EXPECT_EQ(particles.x.head<3>(), Vec3(0, 0, 0));
    EXPECT_EQ(particles.v.head<3>(), Vec3(0, 0, 0));
    EXPECT_NEAR(particles.v[10], 1.0, 1e-14);
    EXPECT_NEAR(particles.x[10], 0.11, 0.0076);  // the first step moves by h/2 or h
    EXPECT_EQ(particles.x[9], 3.0);
  }
}
TEST(Stepper, KeepsAParticleInItsPlaneToRounding) {
  const SpringForce springs = chain_springs(4);
  Particles particles = chain(4);
  Rng rng(3);
  for (double& value : particles.x) value += 0.1 * rng.normal();
  const Vec3 normal = Vec3(1, 2, 2) / 3.0, start = particles.position(2);
  Constraints constraints;
  constraints.add(2, Mat3::Identity() - normal * normal.transpose(), Vec3::Zero());
  Stepper stepper(4, {&springs});
  for (int k = 0; k < 100; ++k) stepper.update_step(particles, constraints, {.time_step = 0.02});
  EXPECT_NEAR(normal.dot(particles.position(2) - start), 0.0, 1e-13);
  EXPECT_GT((particles.position(2) - start).norm(), 1e-3);
}
TEST(Stepper, KeepsMomentumWithoutConstraints) {
  const SpringForce springs = chain_springs(5);
  Particles particles = chain(5);
  Rng rng(7);
  for (double& value : particles.v) value = rng.normal();
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (Index i = 0; i < 5; ++i) sum += particles.mass[i] * particles.v.segment<3>(3 * i);
    return sum;
  };
  const Vec3 start = momentum();
  Stepper stepper(5, {&springs});
  for (int k = 0; k < 20; ++k)
    stepper.update_step(particles, {},
                        {.integrator = Integrator::bdf2, .time_step = 0.05, .linear = kTight});
  EXPECT_LE((momentum() - start).norm(), 1e-10);
}
TEST(Stepper, ForgetsItsHistoryOnRequest) {
  const SpringForce springs = chain_springs(3);
  Particles once = chain(3);
  once.x[4] = 0.3;
  Particles again = once;
  const StepOptions options{.integrator = Integrator::bdf2, .time_step = 0.05};
  Stepper stepper(3, {&springs});
  stepper.update_step(once, {}, options);
  Particles second = again;
  stepper.update_step(second, {}, options);  // uses the history of another motion
  stepper.forget_history();
  stepper.update_step(again, {}, options);
  EXPECT_EQ(again.x, once.x);
  EXPECT_NE(second.x, once.x);
}
TEST(Stepper, IsBitIdenticalForOneAndEightThreads) {
  const Index n = 3000;
  const SpringForce springs = chain_springs(n);
  const auto run = [&] {
    Particles particles = chain(n);
    particles.x[4] = 0.3;
    Stepper stepper(n, {&springs});
    for (int k = 0; k < 3; ++k) stepper.update_step(particles, hold_ends(n), {.time_step = 0.05});
    return particles.x;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(Stepper, SaysWhichParticleIsLost) {
  const ConstantForce force((VecX(6) << 0, 0, 0, kInfinity, 0, 0).finished());
  Particles particles = chain(2);
  Stepper stepper(2, {&force});
  const SolveReport report =
      stepper.update_step(particles, {}, {.integrator = Integrator::runge_kutta4});
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.reason, "particle 1 is at no finite position");
}
TEST(Stepper, RejectsWrongParticlesAndOptions) {
  const SpringForce springs = chain_springs(3);
  Stepper stepper(3, {&springs});
  Particles particles = chain(2);
  EXPECT_THROW(stepper.update_step(particles, {}, {}), Error);
  particles = chain(3);
  EXPECT_THROW(stepper.update_step(particles, {}, {.time_step = 0.0}), Error);
  EXPECT_THROW(stepper.update_step(particles, {}, {.newton_iterations = 0}), Error);
  EXPECT_THROW(stepper.update_step(particles, {}, {.newton_tolerance = 0.0}), Error);
  Constraints constraints;
  constraints.hold(3);
  EXPECT_THROW(stepper.update_step(particles, constraints, {}), Error);
  particles.mass[1] = 0.0;
  EXPECT_THROW(stepper.update_step(particles, {}, {}), Error);
}

}  // namespace coxa::dynamics
