#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/elastic_force.h>
#include <coxa/fem/results.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

const Lame kCartilage = lame_from(12.0, 0.42);

VecX perturbed(const VecX& x, double size, std::uint64_t seed = 2) {
  Rng rng(seed);
  VecX moved = x;
  for (double& value : moved) value += size * rng.normal();
  return moved;
}
VecX no_velocity(const VecX& x) { return VecX::Zero(x.size()); }

// four-node and ten-node elements
class EitherElement : public testing::TestWithParam<int> {
 protected:
  TetMesh of_kind(TetMesh tets) const {
    return GetParam() == 10 ? test::with_mid_nodes(tets) : tets;
  }
  TetMesh mesh = of_kind(test::shaken(test::block(2, 1, 1, Vec3(1, 1.2, 0.8)), 0.1));
};
INSTANTIATE_TEST_SUITE_P(Nodes, EitherElement, testing::Values(4, 10));

TEST_P(EitherElement, HasTheForceOfItsEnergyAndTheJacobianOfItsForce) {
  const ElasticForce force(mesh, make_st_venant_kirchhoff(kCartilage));
  const VecX x = perturbed(test::stacked(mesh.points), 0.03), v = no_velocity(x);
  const VecX f = dynamics::test::force_at(force, x, v);
  EXPECT_LE((f - dynamics::test::numeric_force(force, x)).norm(), 1e-7 * f.norm());
  const MatX K = dynamics::test::given_stiffness(force, x, v);
  EXPECT_LE((K - dynamics::test::numeric_stiffness(force, x, v)).norm(), 1e-8 * K.norm());
}
TEST_P(EitherElement, GivesForceAndEnergyTogetherAsApart) {
  const ElasticForce force(mesh, make_corotational(kCartilage));
  const VecX x = perturbed(test::stacked(mesh.points), 0.03);
  VecX f = VecX::Zero(x.size());
  const double energy = force.add_force_with_energy(x, f);
  EXPECT_NEAR(energy, force.energy(x), 1e-13 * energy);
  EXPECT_EQ(f, dynamics::test::force_at(force, x, no_velocity(x)));
}
TEST_P(EitherElement, KeepsForceAndMomentBalanced) {
  const ElasticForce force(mesh, make_neo_hookean(kCartilage));
  const VecX x = perturbed(test::stacked(mesh.points), 0.03);
  const VecX f = dynamics::test::force_at(force, x, no_velocity(x));
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    sum += f.segment<3>(3 * i);
    moment += Vec3(x.segment<3>(3 * i)).cross(Vec3(f.segment<3>(3 * i)));
  }
  EXPECT_LE(sum.norm(), 1e-12 * f.norm());
  EXPECT_LE(moment.norm(), 1e-11 * f.norm());
}
TEST_P(EitherElement, HasNoForceAfterARigidMotion) {
  const ElasticForce force(mesh, make_corotational(kCartilage));
  const Mat3 R = Eigen::AngleAxisd(2.0, Vec3(1, 1, 2).normalized()).matrix();
  Points moved = (mesh.points * R.transpose()).rowwise() + Vec3(3, -1, 2).transpose();
  const VecX x = test::stacked(moved);
  EXPECT_LE(dynamics::test::force_at(force, x, no_velocity(x)).norm(), 1e-12);
  EXPECT_NEAR(force.energy(x), 0.0, 1e-20);
}
// patch test: the boundary of an irregular mesh follows an affine map, the inside must find it
TEST_P(EitherElement, PassesThePatchTest) {
  TetMesh patch = test::block(3, 3, 3, Vec3::Ones());
  for (Index i = 0; i < patch.n_vertices(); ++i) {
    const Vec3 X = patch.points.row(i);
    if (X.minCoeff() > 0.5 && X.maxCoeff() < 2.5) {
      Rng rng(static_cast<std::uint64_t>(i));
      patch.points.row(i) +=
          0.25 * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).transpose();
    }
  }
  patch = of_kind(patch);
  Mat3 F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.15, 0.1, -0.08, 1.05;
  const ElasticForce force(patch, make_st_venant_kirchhoff(kCartilage));
  dynamics::Particles particles{test::stacked(patch.points), VecX::Zero(patch.points.size()),
                                VecX::Ones(patch.n_vertices())};
  dynamics::Constraints constraints;
  for (Index i = 0; i < patch.n_vertices(); ++i) {
    const Vec3 X = patch.points.row(i);
    if (X.minCoeff() > 1e-9 && X.maxCoeff() < 3.0 - 1e-9) continue;
    constraints.hold(i);
    particles.x.segment<3>(3 * i) = F * X;
  }
  const SolveReport report =
      dynamics::update_relax(particles, {&force}, constraints,
                             {.tolerance = 1e-13, .linear_solver = dynamics::LinearSolver::ldlt});
  EXPECT_LE(report.residual, 1e-11) << report.reason;
  const ElementFields fields = compute_fields(force, particles.x);
  const Mat3 sigma = cauchy_from(force.material().first_piola(F), F);
  for (Index e = 0; e < patch.n_tets(); ++e) {
    EXPECT_LE((fields.deformation_gradient[static_cast<std::size_t>(e)] - F).norm(), 1e-12);
    EXPECT_LE((fields.cauchy_stress[static_cast<std::size_t>(e)] - sigma).norm(), 1e-10);
  }
}
TEST_P(EitherElement, WeighsWhatTheMeshWeighs) {
  const VecX mass = lumped_masses(mesh, 1.1e-9, mesh.n_vertices());
  const ElasticForce force(mesh, make_corotational(kCartilage));
  EXPECT_NEAR(mass.sum(), 1.1e-9 * force.volumes().sum(), 1e-22);
  EXPECT_GT(mass.minCoeff(), 0.0);
}
TEST_P(EitherElement, IsBitIdenticalForOneAndEightThreads) {
  const TetMesh larger = of_kind(test::block(6, 6, 3, Vec3::Ones()));
  const ElasticForce force(larger, make_st_venant_kirchhoff(kCartilage));
  const VecX x = perturbed(test::stacked(larger.points), 0.03);
  const auto all = [&] {
    solve::BlockMatrix A(larger.n_vertices(), force.pattern());
    force.add_jacobian(x, no_velocity(x), 1.0, 0.0, A);
    VecX product;
    A.multiply(x, product);
    return VecX(product + dynamics::test::force_at(force, x, no_velocity(x)) +
                VecX::Constant(x.size(), force.energy(x)));
  };
  EXPECT_EQ(with_threads(1, all), with_threads(8, all));
}

TEST(ElasticForce, TiesNodesToSharedParticlesWithOffsets) {
  const TetMesh mesh = test::shaken(test::block(2, 2, 1, Vec3::Ones()), 0.1);
  const Index n = mesh.n_vertices(), bottom = 9;
  // the nine nodes of the lowest plane are one rigid particle, number 0; the others follow in
  // reverse order
  ParticleMap map;
  map.offset = Points::Zero(n, 3);
  for (Index i = 0; i < n; ++i) map.particle_of.push_back(i < bottom ? 0 : n - i);
  for (Index i = 0; i < bottom; ++i) map.offset.row(i) = mesh.points.row(i);
  const ElasticForce tied(mesh, make_neo_hookean(kCartilage), map);
  const ElasticForce free(mesh, make_neo_hookean(kCartilage));

  const Index n_particles = n - bottom + 1;
  VecX x = VecX::Zero(3 * n_particles);
  for (Index i = bottom; i < n; ++i) x.segment<3>(3 * (n - i)) = mesh.points.row(i).transpose();
  x = perturbed(x, 0.03);
  const Points where = tied.node_positions(x);
  EXPECT_LE((where.row(4) - x.head<3>().transpose() - mesh.points.row(4)).norm(), 1e-15);
  const VecX all = test::stacked(where);
  EXPECT_NEAR(tied.energy(x), free.energy(all), 1e-12);

  const VecX f = dynamics::test::force_at(tied, x, no_velocity(x));
  EXPECT_LE((f - dynamics::test::numeric_force(tied, x)).norm(), 1e-7);
  EXPECT_LE((dynamics::test::given_stiffness(tied, x, no_velocity(x)) -
             dynamics::test::numeric_stiffness(tied, x, no_velocity(x)))
                .norm(),
            1e-6);
  const VecX mass = lumped_masses(mesh, 1.0, n_particles, map);
  EXPECT_NEAR(mass.sum(), tied.volumes().sum(), 1e-12);
}
TEST(ElasticForce, FollowsNewOffsets) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  ElasticForce force(mesh, make_neo_hookean(kCartilage),
                     {.particle_of = std::vector<Index>(8, 0), .offset = mesh.points});
  EXPECT_NEAR(force.energy(VecX::Zero(3)), 0.0, 1e-14);
  force.set_offsets(1.1 * mesh.points);
  EXPECT_NEAR(force.energy(VecX::Zero(3)),
              make_neo_hookean(kCartilage)->energy_density(1.1 * Mat3::Identity()), 1e-12);
  EXPECT_THROW(force.set_offsets(Points::Zero(3, 3)), Error);
}
TEST(ElasticForce, AddsToTheBlocksOfALargerPattern) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const ElasticForce force(mesh, make_neo_hookean(kCartilage));
  const VecX x = test::stacked(mesh.points);
  solve::BlockMatrix small(8, force.pattern());
  force.add_jacobian(x, no_velocity(x), 1.0, 0.0, small);
  std::vector<std::pair<Index, Index>> pairs;
  for (Index i = 0; i < 10; ++i)
    for (Index j = 0; j < 10; ++j) pairs.emplace_back(i, j);
  solve::BlockMatrix large(10, pairs);
  large.at(2, 3).setOnes();
  force.add_jacobian(x, no_velocity(x), 2.0, 0.0, large);
  MatX expected = 2.0 * dynamics::test::dense(small);
  expected.block<3, 3>(6, 9).array() += 1.0;
  EXPECT_LE((dynamics::test::dense(large).topLeftCorner(24, 24) - expected).norm(), 1e-11);
}
TEST(ElasticForce, UsesThePositiveTangentOnRequest) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const ElasticForce exact(mesh, make_st_venant_kirchhoff(kCartilage));
  const ElasticForce positive(mesh, make_st_venant_kirchhoff(kCartilage), {},
                              {.tangent = Tangent::positive});
  const VecX x = 0.6 * test::stacked(mesh.points);
  const auto softest = [&](const ElasticForce& force) {
    return Eigen::SelfAdjointEigenSolver<MatX>(
               dynamics::test::given_stiffness(force, x, no_velocity(x)))
        .eigenvalues()[0];
  };
  EXPECT_LT(softest(exact), -1.0);
  EXPECT_GE(softest(positive), -1e-10);
}
TEST(ElasticForce, RejectsMeshesAndOptionsThatDoNotFit) {
  const auto law = [] { return make_neo_hookean(kCartilage); };
  TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  EXPECT_THROW(ElasticForce(mesh, law(), {.particle_of = {0, 1}, .offset = {}}), Error);
  EXPECT_THROW(ElasticForce(mesh, law(), {.particle_of = {}, .offset = Points::Zero(2, 3)}), Error);
  EXPECT_THROW(ElasticForce(mesh, law(), {}, {.axes = {Mat3::Identity()}}), Error);
  EXPECT_THROW(ElasticForce(mesh, law(), {}, {.axes = std::vector<Mat3>(6, Mat3::Ones())}), Error);
  EXPECT_THROW(lumped_masses(mesh, 0.0, 8), Error);
  EXPECT_THROW(lumped_masses(mesh, 1.0, 7), Error);
  std::swap(mesh.tets(3, 0), mesh.tets(3, 1));
  try {
    ElasticForce(mesh, law());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_mesh);
    EXPECT_NE(std::string(error.what()).find("element 3 has volume -0.16"), std::string::npos)
        << error.what();
  }
  mesh.tets(3, 0) = 99;
  EXPECT_THROW(ElasticForce(mesh, law()), Error);
}

}  // namespace coxa::fem
