#include <coxa/fem/pore_fluid.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {
namespace {

TetMesh some_mesh(int nodes) {
  const TetMesh mesh = test::shaken(test::block(2, 1, 1, Vec3(1, 1.1, 0.9)), 0.1);
  return nodes == 10 ? test::with_mid_nodes(mesh) : mesh;
}
PoreFluid some_fluid(const TetMesh& mesh, double pressure_unit = 0.7) {
  return PoreFluid(mesh, {.reference = 0.3, .solid_share = 0.2, .exponent = 2.0, .stiffening = 1.0},
                   {.pressure_unit = pressure_unit, .stabilisation = 0.4});
}
VecX shaken_state(const PoreFluid& fluid, double size, std::uint64_t seed) {
  Rng rng(seed);
  VecX x = fluid.reference();
  for (double& value : x) value += size * rng.normal();
  return x;
}
/// The state that F takes a mesh to, with pressures p(X) at its corners.
template <class Pressure>
VecX affine_state(const PoreFluid& fluid, const TetMesh& mesh, const Mat3& F,
                  const Pressure& pressure) {
  VecX x = fluid.reference();
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    x.segment<3>(3 * i) = F * mesh.points.row(i).transpose();
  for (const Index node : mesh.tets.reshaped())
    x[3 * fluid.pressure_particle(node)] = pressure(Vec3(mesh.points.row(node)));
  return x;
}
Mat3 some_deformation() {
  Mat3 F;
  F << 1.1, 0.1, 0, 0.05, 0.9, 0.1, 0, 0.2, 0.8;
  return F;
}
std::vector<Index> all_nodes(const TetMesh& mesh) {
  std::vector<Index> nodes(static_cast<std::size_t>(mesh.n_vertices()));
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = static_cast<Index>(i);
  return nodes;
}

}  // namespace

TEST(PoreFluid, HasTheJacobianOfItsForceAndItIsSymmetric) {
  for (const int nodes : {4, 10}) {
    PoreFluid fluid = some_fluid(some_mesh(nodes));
    fluid.begin_step(shaken_state(fluid, 0.03, 5), 0.6);
    const VecX x = shaken_state(fluid, 0.05, 6), v = VecX::Zero(x.size());
    const MatX K = dynamics::test::given_stiffness(fluid, x, v);
    EXPECT_GT(K.norm(), 0.1);
    EXPECT_LE((K - dynamics::test::numeric_stiffness(fluid, x, v)).norm(), 1e-7 * K.norm());
    EXPECT_LE((K - K.transpose()).norm(), 1e-14 * K.norm());
  }
}
TEST(PoreFluid, PushesOnItsBoundaryWithItsPressure) {
  const Mat3 F = some_deformation();
  for (const int nodes : {4, 10}) {
    TetMesh mesh = test::block(2, 2, 2, Vec3::Ones());
    if (nodes == 10) mesh = test::with_mid_nodes(mesh);
    PoreFluid fluid = some_fluid(mesh);
    const VecX x = affine_state(fluid, mesh, F, [](const Vec3&) { return 3.0; });
    fluid.begin_step(x, 1.0);
    const VecX force = dynamics::test::force_at(fluid, x, VecX());
    Vec3 top = Vec3::Zero();
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if (mesh.points(i, 2) > 2.0 - 1e-9) top += force.segment<3>(3 * i);
    // area vector of the deformed top, 4 mm2 at rest: Nanson
    const Vec3 area = F.determinant() * F.inverse().transpose() * Vec3(0, 0, 4.0);
    // edges of the top belong to the sides as well, which push across it
    EXPECT_NEAR(top[2], 0.7 * 3.0 * area[2], 1e-12);
    EXPECT_NEAR(fluid.outflow(x), 0.0, 1e-12);
  }
}
TEST(PoreFluid, FlowsByDarcysLawInTheDeformedShape) {
  const Mat3 F = some_deformation();
  const double k = 0.3 * std::pow((F.determinant() - 0.2) / 0.8, 2.0) *
                   std::exp(0.5 * (F.determinant() * F.determinant() - 1.0));
  const Vec3 slope(0.3, -0.2, 0.5);  // MPa/mm in the deformed shape
  for (const int nodes : {4, 10}) {
    const TetMesh mesh = some_mesh(nodes);
    PoreFluid fluid = some_fluid(mesh, 2.0);
    const VecX x =
        affine_state(fluid, mesh, F, [&](const Vec3& X) { return 0.5 * slope.dot(F * X); });
    fluid.begin_step(x, 1.0);
    for (Index e = 0; e < mesh.n_tets(); ++e)
      EXPECT_LE((Vec3(fluid.flow(x).row(e)) + k * slope).norm(), 1e-13);
  }
}
TEST(PoreFluid, TellsHowMuchFlowsThroughABlock) {
  // pressure 3 MPa at the bottom, none at the top of a block 2 by 2 by 2 mm squeezed to 1.6 mm
  const double stretch = 0.8, k = 0.3 * std::pow(0.75, 2.0) * std::exp(0.5 * (0.64 - 1.0));
  const Mat3 F = Vec3(1, 1, stretch).asDiagonal();
  const TetMesh mesh = test::with_mid_nodes(test::block(2, 2, 2, Vec3::Ones()));
  PoreFluid fluid = some_fluid(mesh, 1.0);
  const VecX x = affine_state(fluid, mesh, F, [&](const Vec3& X) { return 1.5 * (2.0 - X[2]); });
  fluid.begin_step(x, 0.5);
  const VecX force = dynamics::test::force_at(fluid, x, VecX());
  double through_top = 0.0, inside = 0.0;
  for (const Index node : all_nodes(test::block(2, 2, 2, Vec3::Ones()))) {
    const double left = force[3 * fluid.pressure_particle(node)];
    if (mesh.points(node, 2) > 2.0 - 1e-9) through_top -= left;
    if (std::abs(mesh.points(node, 2) - 1.0) < 1e-9) inside += std::abs(left);
  }
  EXPECT_NEAR(through_top, 0.5 * 4.0 * k * 3.0 / 1.6, 1e-12);
  EXPECT_NEAR(inside, 0.0, 1e-12);
}
TEST(PoreFluid, LosesWhatTheBodyLosesInVolume) {
  for (const int nodes : {4, 10}) {
    const TetMesh mesh = some_mesh(nodes);
    PoreFluid fluid = some_fluid(mesh);
    const VecX before = shaken_state(fluid, 0.03, 5), after = shaken_state(fluid, 0.03, 6);
    fluid.begin_step(before, 0.6);
    EXPECT_NEAR(fluid.outflow(after), fluid.volume(before) - fluid.volume(after), 1e-12);
    EXPECT_GT(std::abs(fluid.outflow(after)), 1e-3);
  }
}
TEST(PoreFluid, ChangesOnlyTheScaleOfPressuresWithItsUnit) {
  const TetMesh mesh = some_mesh(10);
  const auto force_with = [&](double unit) {
    PoreFluid fluid = some_fluid(mesh, unit);
    VecX x = shaken_state(fluid, 0.03, 5);
    const Eigen::Index n = 3 * mesh.n_vertices();
    x.tail(x.size() - n) *= 0.7 / unit;
    fluid.begin_step(fluid.reference(), 0.6);
    VecX force = dynamics::test::force_at(fluid, x, VecX());
    force.tail(x.size() - n) *= 0.7 / unit;
    EXPECT_LE((fluid.pressure(x) - some_fluid(mesh).pressure(shaken_state(fluid, 0.03, 5))).norm(),
              1e-14);
    return force;
  };
  EXPECT_LE((force_with(0.7) - force_with(5.0)).norm(), 1e-12);
}
TEST(PoreFluid, GivesMidNodesTheMeanOfTheirEnds) {
  const TetMesh mesh = some_mesh(10);
  const PoreFluid fluid = some_fluid(mesh, 2.0);
  const VecX x = affine_state(fluid, mesh, Mat3::Identity(), [](const Vec3& X) { return X[0]; });
  EXPECT_LE((fluid.pressure(x) - 2.0 * mesh.points.col(0)).norm(), 1e-13);
}
TEST(PoreFluid, StabilisationLeavesPressuresAloneThatAreEvenOverElements) {
  const TetMesh mesh = some_mesh(4);
  const auto resisting = [&](double stabilisation, double varying) {
    PoreFluid fluid(mesh, {.reference = 1e-12},
                    {.pressure_unit = 1.0, .stabilisation = stabilisation});
    fluid.begin_step(fluid.reference(), 1.0);
    const VecX x = affine_state(fluid, mesh, Mat3::Identity(),
                                [&](const Vec3& X) { return 2.0 + varying * X[0]; });
    return dynamics::test::force_at(fluid, x, VecX())
        .tail(3 * (fluid.n_particles() - mesh.n_vertices()))
        .norm();
  };
  EXPECT_LE(resisting(0.5, 0.0), 1e-12);
  EXPECT_GT(resisting(0.5, 1.0), 1e-3);
  EXPECT_NEAR(resisting(1.0, 1.0), 2.0 * resisting(0.5, 1.0), 1e-9);
}
TEST(PoreFluid, IsBitIdenticalForOneAndEightThreads) {
  const TetMesh mesh = test::with_mid_nodes(test::block(4, 4, 2, Vec3::Ones()));
  const auto all = [&] {
    PoreFluid fluid = some_fluid(mesh);
    fluid.begin_step(shaken_state(fluid, 0.03, 5), 0.6);
    const VecX x = shaken_state(fluid, 0.02, 6);
    solve::BlockMatrix A(fluid.n_particles(), fluid.pattern());
    fluid.add_jacobian(x, VecX(), 1.0, 0.0, A);
    VecX product;
    A.multiply(x, product);
    return VecX(product + dynamics::test::force_at(fluid, x, VecX()) +
                VecX::Constant(x.size(), fluid.volume(x) + fluid.outflow(x) + fluid.flow(x).sum()));
  };
  EXPECT_EQ(with_threads(1, all), with_threads(8, all));
}
TEST(PoreFluid, SaysWhatIsOutOfRange) {
  const TetMesh four = some_mesh(4), ten = some_mesh(10);
  const auto text_of = [](const auto& body) -> std::string {
    try {
      body();
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const auto holds = [&](const std::string& part, const auto& body) {
    const std::string text = text_of(body);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  holds("the permeability must be positive, got 0", [&] { PoreFluid(ten, {.reference = 0.0}); });
  holds("share must be in [0, 1), got 1", [&] { PoreFluid(ten, {.solid_share = 1.0}); });
  holds("got -1 and 0", [&] { PoreFluid(ten, {.exponent = -1.0}); });
  holds("got 0 and -2", [&] { PoreFluid(ten, {.stiffening = -2.0}); });
  holds("pressure unit must be positive", [&] { PoreFluid(ten, {}, {.pressure_unit = 0.0}); });
  holds("stabilisation must not be negative", [&] { PoreFluid(ten, {}, {.stabilisation = -1.0}); });
  holds("four-node elements need a positive stabilisation", [&] { PoreFluid(four, {}); });
  PoreFluid fluid(ten, {});
  holds("time step must be positive, got 0", [&] { fluid.begin_step(fluid.reference(), 0.0); });
  holds("node 12 is no corner", [&] { fluid.pressure_particle(12); });
  holds("there is no node -1", [&] {
    dynamics::Constraints constraints;
    fluid.add_drained({-1}, constraints);
  });
}

}  // namespace coxa::fem
