#include <coxa/fem/mean_dilatation.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

VecX shaken_positions(const TetMesh& mesh, double size) {
  Rng rng(8);
  VecX x = test::stacked(mesh.points);
  for (double& value : x) value += size * rng.normal();
  return x;
}
TetMesh some_mesh(int nodes) {
  const TetMesh mesh = test::shaken(test::block(2, 1, 1, Vec3(1, 1.1, 0.9)), 0.1);
  return nodes == 10 ? test::with_mid_nodes(mesh) : mesh;
}

TEST(MeanDilatation, HasTheForceOfItsEnergyAndItsJacobian) {
  for (const int nodes : {4, 10}) {
    const TetMesh mesh = some_mesh(nodes);
    const MeanDilatation force(mesh, volume_patches(mesh), 20.0);
    const VecX x = shaken_positions(mesh, 0.03), v = VecX::Zero(x.size());
    const VecX f = dynamics::test::force_at(force, x, v);
    EXPECT_GT(f.norm(), 0.1);
    EXPECT_LE((f - dynamics::test::numeric_force(force, x)).norm(), 1e-7 * f.norm());
    const MatX K = dynamics::test::given_stiffness(force, x, v);
    EXPECT_LE((K - dynamics::test::numeric_stiffness(force, x, v)).norm(), 1e-7 * K.norm());
  }
}
TEST(MeanDilatation, GivesTheStressOfTheLawItReplacesForAHomogeneousDeformation) {
  const Lame lame = lame_from(12.0, 0.45);
  Mat3 F;
  F << 1.2, 0.1, 0, 0.05, 0.9, 0.1, 0, 0.2, 1.1;
  for (const int nodes : {4, 10}) {
    const TetMesh mesh = some_mesh(nodes);
    const VecX x = test::stacked(mesh.points * F.transpose());
    const MeanDilatation volume(mesh, volume_patches(mesh), lame.lambda);
    const ElasticForce isochoric(mesh, make_neo_hookean({0.0, lame.mu}));
    const ElasticForce whole(mesh, make_neo_hookean(lame));
    EXPECT_NEAR(volume.energy(x) + isochoric.energy(x), whole.energy(x), 1e-11);
    EXPECT_LE((isochoric.cauchy_stress(x, 3) + volume.mean_stress(x)[3] * Mat3::Identity() -
               whole.cauchy_stress(x, 3))
                  .norm(),
              1e-11);
  }
}
TEST(MeanDilatation, LetsAPatchKeepItsVolumeWithoutStress) {
  // two patches' worth of elements as one: nodes move inside, the whole keeps its volume
  const TetMesh mesh = test::block(2, 2, 2, Vec3::Ones());
  const MeanDilatation one(mesh, std::vector<Index>(48, 0), 20.0);
  VecX x = test::stacked(mesh.points);
  x.segment<3>(3 * 13) += Vec3(0.2, -0.1, 0.1);  // the middle node
  EXPECT_NEAR(one.energy(x), 0.0, 1e-20);
}
TEST(MeanDilatation, IsBitIdenticalForOneAndEightThreads) {
  const TetMesh mesh = test::block(6, 6, 3, Vec3::Ones());
  const MeanDilatation force(mesh, volume_patches(mesh), 20.0);
  const VecX x = shaken_positions(mesh, 0.02), v = VecX::Zero(x.size());
  const auto all = [&] {
    solve::BlockMatrix A(mesh.n_vertices(), force.pattern());
    force.add_jacobian(x, v, 1.0, 0.0, A);
    VecX product;
    A.multiply(x, product);
    return VecX(product + dynamics::test::force_at(force, x, v) +
                VecX::Constant(x.size(), force.energy(x)));
  };
  EXPECT_EQ(with_threads(1, all), with_threads(8, all));
}
TEST(MeanDilatation, FollowsParticlesAndOffsets) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  MeanDilatation force(mesh, volume_patches(mesh), 20.0,
                       {.particle_of = std::vector<Index>(8, 0), .offset = mesh.points});
  EXPECT_NEAR(force.energy(Vec3(5, 6, 7)), 0.0, 1e-20);
  force.set_offsets(1.1 * mesh.points);
  EXPECT_NEAR(force.energy(Vec3(5, 6, 7)), 10.0 * std::pow(3.0 * std::log(1.1), 2), 1e-10);
}
TEST(MeanDilatation, ForbidsAPatchWithoutVolume) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const MeanDilatation force(mesh, volume_patches(mesh), 20.0);
  EXPECT_EQ(force.energy(-test::stacked(mesh.points)), kInfinity);
}
TEST(MeanDilatation, RejectsPatchesThatDoNotFit) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  EXPECT_THROW(MeanDilatation(mesh, {0, 0}, 1.0), Error);
  EXPECT_THROW(MeanDilatation(mesh, {0, 0, 0, 0, 0, 2}, 1.0), Error);
  EXPECT_THROW(MeanDilatation(mesh, {0, 0, 0, 0, 0, -1}, 1.0), Error);
  EXPECT_THROW(MeanDilatation(mesh, volume_patches(mesh), 0.0), Error);
}

TEST(VolumePatches, CoverEveryElementWithPatchesOfAFewElements) {
  const TetMesh mesh = test::block(8, 8, 3, Vec3::Ones());
  const std::vector<Index> patch_of = volume_patches(mesh);
  const Index n = *std::max_element(patch_of.begin(), patch_of.end()) + 1;
  std::vector<int> size(static_cast<std::size_t>(n), 0);
  for (const Index patch : patch_of) {
    ASSERT_GE(patch, 0);
    ++size[static_cast<std::size_t>(patch)];
  }
  EXPECT_GE(*std::min_element(size.begin(), size.end()), 4);
  EXPECT_LE(*std::max_element(size.begin(), size.end()), 48);
  EXPECT_NEAR(static_cast<double>(mesh.n_tets()) / n, 14.0, 8.0);
}
TEST(VolumePatches, AreTheElementsThemselvesWithTenNodes) {
  const TetMesh mesh = test::with_mid_nodes(test::block(1, 1, 1, Vec3::Ones()));
  EXPECT_EQ(volume_patches(mesh), (std::vector<Index>{0, 1, 2, 3, 4, 5}));
}

}  // namespace coxa::fem
