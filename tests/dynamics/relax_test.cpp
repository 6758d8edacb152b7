#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace coxa::dynamics {

// n masses hang from particle 0 on springs of 10 N/mm, each pulled down by 2 N
struct Hanging {
  explicit Hanging(Index n)
      : particles{VecX::Zero(3 * n), VecX::Ones(3 * n), VecX::Ones(n)},
        weight(weights(n)),
        springs(links(n)) {
    for (Index i = 0; i < n; ++i) particles.x.segment<3>(3 * i) = Vec3(i, 0.3 * (i % 2), 0);
    constraints.hold(0);
  }
  static VecX weights(Index n) {
    VecX force = VecX::Zero(3 * n);
    for (Index i = 0; i < n; ++i) force[3 * i + 2] = -2.0;
    return force;
  }
  static std::vector<Spring> links(Index n) {
    std::vector<Spring> springs;
    for (Index i = 0; i + 1 < n; ++i)
      springs.push_back({.a = i, .b = i + 1, .rest_length = 1.0, .stiffness = 10.0});
    return springs;
  }
  Particles particles;
  ConstantForce weight;
  SpringForce springs;
  Constraints constraints;
};

void expect_hanging(const Particles& particles) {
  double z = 0.0;
  for (Index i = 1; i < particles.n(); ++i) {
    z -= 1.0 + 0.2 * (particles.n() - i);
    EXPECT_NEAR(particles.x[3 * i + 2], z, 1e-5);
    EXPECT_NEAR(particles.x[3 * i], 0.0, 1e-4);
  }
}

TEST(Relax, LetsAChainHangStraightFromALargeSwing) {
  for (const LinearSolver solver : {LinearSolver::conjugate_gradient, LinearSolver::ldlt}) {
    Hanging h(6);
    const SolveReport report = update_relax(h.particles, {&h.weight, &h.springs}, h.constraints,
                                            {.tolerance = 1e-8,
                                             .reference_force = 2.0,
                                             .max_iterations = 500,
                                             .linear_solver = solver});
    EXPECT_TRUE(report.converged) << report.reason;
    EXPECT_LE(report.residual, 1e-8);
    EXPECT_EQ(h.particles.position(0), Vec3(0, 0, 0));
    EXPECT_EQ(h.particles.v, VecX::Zero(18));
    expect_hanging(h.particles);
  }
}
TEST(Relax, HoldsAParticleInItsPlaneWithEitherSolver) {
  for (const LinearSolver solver : {LinearSolver::conjugate_gradient, LinearSolver::ldlt}) {
    Hanging h(3);
    const Vec3 normal = Vec3(1, 0, 1).normalized(), start = h.particles.position(2);
    h.constraints.add(2, Mat3::Identity() - normal * normal.transpose(), Vec3::Zero());
    const SolveReport report =
        update_relax(h.particles, {&h.weight, &h.springs}, h.constraints,
                     {.tolerance = 1e-9, .max_iterations = 500, .linear_solver = solver});
    EXPECT_TRUE(report.converged) << report.reason;
    EXPECT_NEAR(normal.dot(h.particles.position(2) - start), 0.0, 1e-13);
    VecX force = total_force({&h.weight, &h.springs}, h.particles.x, VecX::Zero(9));
    // what is left on the particle presses on the plane
    EXPECT_LE(force.tail<3>().cross(normal).norm(), 1e-8);
    EXPECT_GT(force.tail<3>().norm(), 0.1);
  }
}

// no energy: the residual guides the search
struct Restoring : Force {
  std::vector<std::pair<Index, Index>> pattern() const override { return {}; }
  void add_force(const VecX& x, const VecX&, VecX& force) const override {
    force.array() -= x.array() / (1.0 + x.array().square()).sqrt();
  }
  void add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                    solve::BlockMatrix& A) const override {
    for (Index i = 0; i < A.n(); ++i)
      A.at(i, i).diagonal().array() +=
          stiffness_factor * (1.0 + x.segment<3>(3 * i).array().square()).pow(-1.5);
  }
  double energy(const VecX&) const override { return kNaN; }
};
TEST(Relax, SearchesOnTheResidualWhereAForceHasNoEnergy) {
  const Restoring force;
  Particles particles{VecX::Constant(6, 3.0), VecX::Zero(6), VecX::Ones(2)};
  const SolveReport report = update_relax(particles, {&force}, {}, {.tolerance = 1e-10});
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_LE(particles.x.norm(), 1e-9);
}
TEST(Relax, MeasuresTheResidualInTheReferenceForce) {
  Hanging h(2);
  const SolveReport report = update_relax(h.particles, {&h.weight}, h.constraints,
                                          {.reference_force = 4.0, .max_iterations = 0});
  EXPECT_FALSE(report.converged);
  EXPECT_NEAR(report.residual, 0.5, 1e-14);
}
TEST(Relax, LimitsTheMoveOfOneIterationOnRequest) {
  Hanging h(2);
  const VecX start = h.particles.x;
  update_relax(h.particles, {&h.weight, &h.springs}, h.constraints,
               {.max_iterations = 1, .max_step = 0.01});
  EXPECT_LE((h.particles.x - start).cwiseAbs().maxCoeff(), 0.01 + 1e-15);
  EXPECT_GT((h.particles.x - start).norm(), 0.0);
}
TEST(Relax, ReportsThatNothingHoldsTheLoad) {
  Hanging h(2);
  const SolveReport report = update_relax(h.particles, {&h.weight}, h.constraints, {});
  EXPECT_FALSE(report.converged);
  EXPECT_FALSE(report.reason.empty());
}
TEST(Relax, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] {
    Hanging h(600);
    update_relax(h.particles, {&h.weight, &h.springs}, h.constraints,
                 {.max_iterations = 2, .linear = {.max_iterations = 50}});
    return h.particles.x;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(Relax, RejectsABadReferenceForce) {
  Hanging h(2);
  EXPECT_THROW(update_relax(h.particles, {&h.weight}, {}, {.reference_force = 0.0}), Error);
}

}  // namespace coxa::dynamics
