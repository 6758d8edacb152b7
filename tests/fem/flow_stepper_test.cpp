#include <coxa/fem/flow_stepper.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/elastic_force.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fem/shapes.h"

namespace coxa::fem {
namespace {

constexpr double kMu = 0.4, kLambda = 0.3;  // MPa

TetMesh block_of(int nodes, Index n, Index layers) {
  const TetMesh mesh = test::shaken(test::block(n, n, layers, Vec3::Ones()), 0.0);
  return nodes == 10 ? test::with_mid_nodes(mesh) : mesh;
}
std::vector<Index> nodes_at_height(const TetMesh& mesh, double z) {
  std::vector<Index> nodes;
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    if (std::abs(mesh.points(i, 2) - z) < 1e-9) nodes.push_back(i);
  return nodes;
}
/// What slides on the planes x, y, z = 0 (and, when confined, on those at `width`).
dynamics::Constraints on_planes(const PoreFluid& fluid, const TetMesh& mesh, double width) {
  dynamics::Constraints constraints;
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    Vec3 free = Vec3::Ones();
    for (int c = 0; c < 3; ++c)
      if (mesh.points(i, c) < 1e-9 || (c < 2 && mesh.points(i, c) > width - 1e-9)) free[c] = 0.0;
    if (free != Vec3::Ones()) constraints.add(i, free.asDiagonal(), Vec3::Zero());
  }
  fluid.add_unused(constraints);
  return constraints;
}
PoreFluidOptions options_for(int nodes) {
  return {.pressure_unit = 0.5, .stabilisation = nodes == 4 ? 0.5 / kMu : 0.0};
}

/// A block pressed down at its top by a platen, to `stretch` in one step of `time_step`.
struct Pressed {
  TetMesh mesh;
  PoreFluid fluid;
  ElasticForce solid;
  VecX x;
  SolveReport report;
  Pressed(int nodes, double stretch, double time_step, double width, bool drained)
      : mesh(block_of(nodes, 2, 2)),
        fluid(mesh, {.reference = 1.0}, options_for(nodes)),
        solid(mesh, make_neo_hookean({kLambda, kMu})),
        x(fluid.reference()) {
    auto constraints = on_planes(fluid, mesh, width);
    const auto top = nodes_at_height(mesh, 2.0);
    for (const Index i : top) {
      Vec3 free(1, 1, 0);
      for (int c = 0; c < 2; ++c)
        if (mesh.points(i, c) < 1e-9 || mesh.points(i, c) > width - 1e-9) free[c] = 0.0;
      constraints.add(i, free.asDiagonal(), Vec3::Zero());
    }
    if (drained) fluid.add_drained(top, constraints);
    FlowStepper stepper(fluid, {&solid}, x);
    for (Index i = 0; i < mesh.n_vertices(); ++i) x[3 * i + 2] *= stretch;
    report = stepper.update_step(x, constraints, {.time_step = time_step, .tolerance = 1e-11});
  }
  /// Force of the platen, N.
  double force() const {
    VecX sum = VecX::Zero(x.size());
    solid.add_force(x, VecX(), sum);
    fluid.add_force(x, VecX(), sum);
    double total = 0.0;
    for (const Index i : nodes_at_height(mesh, 2.0)) total += sum[3 * i + 2];
    return total;
  }
};

}  // namespace

TEST(FlowStepper, SealedBodyKeepsItsVolumeAndIsNeoHookean) {
  // incompressible, sides free: true force mu (1/stretch^2 - stretch) over the area at rest
  const double stretch = 0.7;
  for (const int nodes : {4, 10}) {
    const Pressed pressed(nodes, stretch, 1e-3, 10.0, false);
    ASSERT_TRUE(pressed.report.converged) << pressed.report.reason;
    EXPECT_NEAR(pressed.fluid.volume(pressed.x), 8.0, 1e-9);
    EXPECT_NEAR(pressed.force(), 4.0 * kMu * (1.0 / (stretch * stretch) - stretch), 1e-8);
    // pressure: what keeps the sides free of stress, mu (1/stretch - 1)
    const VecX p = pressed.fluid.pressure(pressed.x);
    EXPECT_LE((p.array() - kMu * (1.0 / stretch - 1.0)).abs().maxCoeff(), 1e-8);
  }
}
TEST(FlowStepper, DrainedBodyIsTheSolidAlone) {
  const double stretch = 0.8;
  for (const int nodes : {4, 10}) {
    const Pressed pressed(nodes, stretch, 1e12, 2.0, true);
    ASSERT_TRUE(pressed.report.converged) << pressed.report.reason;
    EXPECT_LE(pressed.fluid.pressure(pressed.x).cwiseAbs().maxCoeff(), 1e-10);
    const double stress = kMu * (stretch - 1.0 / stretch) + kLambda * std::log(stretch) / stretch;
    EXPECT_NEAR(pressed.force(), -4.0 * stress, 1e-9);
    EXPECT_NEAR(pressed.fluid.outflow(pressed.x), 8.0 * (1.0 - stretch), 1e-9);
  }
}

/// Creep of a confined column under a small load, open at its top: settlement over the final one.
double consolidation(int nodes, double last_time, int steps, double* lost = nullptr) {
  const double modulus = kLambda + 2.0 * kMu, height = 8.0, load = 1e-5 * modulus;
  TetMesh mesh = test::block(1, 1, 8, Vec3::Ones());
  if (nodes == 10) mesh = test::with_mid_nodes(mesh);
  PoreFluid fluid(mesh, {.reference = height * height / modulus}, options_for(nodes));  // T = t
  const ElasticForce solid(mesh, make_neo_hookean({kLambda, kMu}));
  VecX weight = VecX::Zero(fluid.reference().size());
  const auto top = nodes_at_height(mesh, height);
  // even pressure on two triangles: thirds to corners, or to the middles of edges
  for (const Index i : top) {
    const double x = mesh.points(i, 0), y = mesh.points(i, 1);
    const bool corner = (x == 0.0 || x == 1.0) && (y == 0.0 || y == 1.0), shared = x == y;
    if (corner != (nodes == 10)) weight[3 * i + 2] = -load / 6.0 * (shared ? 2.0 : 1.0);
  }
  const dynamics::ConstantForce press(weight);
  auto constraints = on_planes(fluid, mesh, 1.0);
  fluid.add_drained(top, constraints);
  VecX x = fluid.reference();
  FlowStepper stepper(fluid, {&solid, &press}, x);
  double total = 0.0, time = 1e-4, before = 0.0;
  const double growth = std::pow(last_time / time, 1.0 / steps);
  for (int k = 0; k <= steps; ++k, before = time, time *= growth) {
    const SolveReport report = stepper.update_step(
        x, constraints, {.time_step = time - before, .tolerance = 1e-9, .reference_force = load});
    EXPECT_TRUE(report.converged) << report.reason;
    total += fluid.outflow(x);
  }
  if (lost != nullptr)
    *lost = (total - (fluid.volume(fluid.reference()) - fluid.volume(x))) / total;
  EXPECT_NEAR(stepper.time(), last_time, 1e-9);
  return (height - x[3 * top[0] + 2]) / (load * height / modulus);
}
TEST(FlowStepper, FollowsTerzaghisConsolidation) {
  for (const int nodes : {4, 10}) {
    double lost = kNaN;
    const double tolerance = nodes == 10 ? 0.01 : 0.02;
    EXPECT_NEAR(consolidation(nodes, 0.1, 100, &lost), 0.356823, tolerance * 0.356823);
    EXPECT_NEAR(lost, 0.0, 1e-8);  // fluid over all steps against the change of volume
    EXPECT_NEAR(consolidation(nodes, 0.5, 100), 0.763950, tolerance * 0.763950);
  }
}
TEST(FlowStepper, IsOfFirstOrderInTime) {
  const double fine = consolidation(10, 0.1, 160);
  const double coarse_error = consolidation(10, 0.1, 20) - fine;
  const double half_error = consolidation(10, 0.1, 40) - fine;
  EXPECT_NEAR(coarse_error / half_error, 2.0, 0.35);
}
TEST(FlowStepper, GivesForcesOfRateTheMeanVelocityOfTheStep) {
  // nothing but damping: the body goes at force over damping, and keeps its shape and its fluid
  const TetMesh mesh = block_of(10, 1, 1);
  PoreFluid fluid(mesh, {.reference = 1.0});
  const Index n = mesh.n_vertices();
  VecX mass = VecX::Ones(fluid.n_particles()), pull = VecX::Zero(fluid.reference().size());
  for (Index i = 0; i < n; ++i) pull[3 * i] = 4.0;
  const dynamics::MassDamping damping(mass, 5.0);
  const dynamics::ConstantForce force(pull);
  dynamics::Constraints constraints;
  fluid.add_unused(constraints);
  fluid.add_drained({0}, constraints);
  FlowStepper stepper(fluid, {&damping, &force}, fluid.reference());
  VecX x = fluid.reference();
  ASSERT_TRUE(stepper.update_step(x, constraints, {.time_step = 0.5}).converged);
  ASSERT_TRUE(stepper.update_step(x, constraints, {.time_step = 0.25}).converged);
  for (Index i = 0; i < n; ++i) EXPECT_NEAR(x[3 * i] - mesh.points(i, 0), 0.75 * 4.0 / 5.0, 1e-7);
  EXPECT_LE(fluid.pressure(x).norm(), 1e-7);
}
TEST(FlowStepper, IsBitIdenticalForOneAndEightThreads) {
  const auto all = [] { return Pressed(10, 0.7, 1.0, 10.0, true).x; };
  EXPECT_EQ(with_threads(1, all), with_threads(8, all));
}
TEST(FlowStepper, TriesAgainFromTheSameStartAfterAFailure) {
  const TetMesh mesh = block_of(10, 2, 2);
  PoreFluid fluid(mesh, {.reference = 1.0});
  const ElasticForce solid(mesh, make_neo_hookean({kLambda, kMu}));
  auto constraints = on_planes(fluid, mesh, 2.0);
  const auto top = nodes_at_height(mesh, 2.0);
  for (const Index i : top) constraints.hold(i);
  fluid.add_drained(top, constraints);
  const auto pressed = [&](double stretch) {
    VecX x = fluid.reference();
    for (const Index i : top) x[3 * i + 2] = 2.0 * stretch;
    return x;
  };
  FlowStepper stepper(fluid, {&solid}, fluid.reference());
  VecX x = pressed(0.9);
  const SolveReport failed =
      stepper.update_step(x, constraints, {.tolerance = 1e-12, .max_iterations = 1});
  EXPECT_FALSE(failed.converged);
  EXPECT_NE(failed.reason.find("after 1 Newton iterations"), std::string::npos) << failed.reason;
  EXPECT_EQ(stepper.time(), 0.0);
  x = pressed(0.9);
  EXPECT_TRUE(stepper.update_step(x, constraints, {}).converged);
  FlowStepper other(fluid, {&solid}, fluid.reference());
  VecX once = pressed(0.9);
  EXPECT_TRUE(other.update_step(once, constraints, {}).converged);
  EXPECT_EQ(x, once);
  EXPECT_EQ(stepper.time(), 1.0);
}
TEST(FlowStepper, WantsCoordinatesOfEveryParticle) {
  const TetMesh mesh = block_of(10, 1, 1);
  PoreFluid fluid(mesh, {});
  EXPECT_THROW(FlowStepper(fluid, {}, test::stacked(mesh.points)), Error);
  FlowStepper stepper(fluid, {}, fluid.reference());
  VecX x = test::stacked(mesh.points);
  EXPECT_THROW(stepper.update_step(x, {}, {}), Error);
}

}  // namespace coxa::fem
