#include <coxa/fem/mean_dilatation.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/dynamics/system.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

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

constexpr Dilatation kAll[] = {Dilatation::log_volume, Dilatation::stretch_sum,
                               Dilatation::green_trace};

/// The law whose volumetric part a dilatation is.
std::unique_ptr<Material> law_of(Dilatation dilatation, const Lame& lame) {
  return dilatation == Dilatation::log_volume    ? make_neo_hookean(lame)
         : dilatation == Dilatation::stretch_sum ? make_corotational(lame)
                                                 : make_st_venant_kirchhoff(lame);
}
MeanDilatation patches_of(const TetMesh& mesh, double lambda, Dilatation dilatation,
                          Tangent tangent = Tangent::exact) {
  return MeanDilatation(mesh, volume_patches(mesh), lambda, {}, {dilatation, tangent});
}

TEST(MeanDilatation, HasTheForceOfItsEnergyAndItsJacobian) {
  for (const Dilatation dilatation : kAll)
    for (const int nodes : {4, 10}) {
      const TetMesh mesh = some_mesh(nodes);
      const MeanDilatation force = patches_of(mesh, 20.0, dilatation);
      const VecX x = shaken_positions(mesh, 0.03), v = VecX::Zero(x.size());
      const VecX f = dynamics::test::force_at(force, x, v);
      EXPECT_GT(f.norm(), 0.1);
      EXPECT_LE((f - dynamics::test::numeric_force(force, x)).norm(), 1e-7 * f.norm());
      const MatX K = dynamics::test::given_stiffness(force, x, v);
      EXPECT_LE((K - dynamics::test::numeric_stiffness(force, x, v)).norm(), 1e-7 * K.norm());
      VecX also = VecX::Zero(x.size());
      EXPECT_NEAR(force.add_force_with_energy(x, also), force.energy(x), 1e-12 * force.energy(x));
    }
}
TEST(MeanDilatation, HasItsForceAndJacobianThroughInversion) {
  // one element turned inside out: the sum of its signed stretches is still smooth
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const MeanDilatation force = patches_of(mesh, 20.0, Dilatation::stretch_sum);
  VecX x = shaken_positions(mesh, 0.05);
  x.segment<3>(0) += Vec3(1.4, 1.1, 0.9);
  const VecX v = VecX::Zero(x.size()), f = dynamics::test::force_at(force, x, v);
  EXPECT_LE((f - dynamics::test::numeric_force(force, x)).norm(), 1e-6 * f.norm());
  const MatX K = dynamics::test::given_stiffness(force, x, v);
  EXPECT_LE((K - dynamics::test::numeric_stiffness(force, x, v)).norm(), 1e-5 * K.norm());
}
TEST(MeanDilatation, PartsOfItsJacobianMakeTheWhole) {
  for (const Dilatation dilatation : kAll)
    for (const int nodes : {4, 10}) {
      const TetMesh mesh = some_mesh(nodes);
      const MeanDilatation force = patches_of(mesh, 20.0, dilatation);
      const VecX x = shaken_positions(mesh, 0.03), z = shaken_positions(mesh, 1.0);
      solve::BlockMatrix whole(mesh.n_vertices(), force.pattern()), part = whole;
      force.add_jacobian(x, VecX::Zero(x.size()), 1.0, 0.0, whole);
      force.add_element_jacobian(x, part);
      VecX wanted, got;
      whole.multiply(z, wanted);
      part.multiply(z, got);
      const PatchTerms terms = force.patch_terms(x);
      for (std::size_t k = 0; k < terms.stiffness.size(); ++k) {
        const auto each = [&](const auto& body) {
          for (auto i = static_cast<std::size_t>(terms.start[k]);
               i < static_cast<std::size_t>(terms.start[k + 1]); ++i)
            body(3 * Eigen::Index{terms.particle[i]}, terms.slope[i]);
        };
        double change = 0.0;
        each([&](Eigen::Index at, const Vec3& slope) { change += slope.dot(z.segment<3>(at)); });
        each([&](Eigen::Index at, const Vec3& slope) {
          got.segment<3>(at) += terms.stiffness[k] * change * slope;
        });
      }
      EXPECT_LE((got - wanted).norm(), 1e-12 * wanted.norm());
    }
}
TEST(MeanDilatation, WithTheLawBesideItIsTheSumOfBoth) {
  for (const Dilatation dilatation : kAll)
    for (const int nodes : {4, 10}) {
      const TetMesh mesh = some_mesh(nodes);
      const MeanDilatation patches = patches_of(mesh, 20.0, dilatation, Tangent::positive);
      const ElasticForce law(mesh, make_compacting(law_of(dilatation, {0.0, 5.0}), {0.9, 100.0}),
                             {}, {.axes = {}, .tangent = Tangent::positive});
      const VecX x = shaken_positions(mesh, 0.03), z = shaken_positions(mesh, 1.0);
      VecX apart = VecX::Zero(x.size()), together = apart;
      const double energy =
          law.add_force_with_energy(x, apart) + patches.add_force_with_energy(x, apart);
      EXPECT_NEAR(patches.add_force_with_energy(x, law.material(), together), energy,
                  1e-12 * energy);
      EXPECT_LE((together - apart).norm(), 1e-12 * apart.norm());
      solve::BlockMatrix A(mesh.n_vertices(), law.pattern()), B = A;
      law.add_jacobian(x, VecX(), 1.0, 0.0, A);
      patches.add_element_jacobian(x, A);
      patches.add_element_jacobian(x, law.material(), B);
      A.multiply(z, apart);
      B.multiply(z, together);
      EXPECT_LE((together - apart).norm(), 1e-12 * apart.norm());
    }
}
TEST(MeanDilatation, PositiveTangentLeavesOutWhatPressureTakes) {
  const TetMesh mesh = some_mesh(4);
  for (const Dilatation dilatation : {Dilatation::stretch_sum, Dilatation::green_trace})
    for (const double size : {0.9, 1.1}) {
      const VecX x = size * shaken_positions(mesh, 0.02), v = VecX::Zero(x.size());
      const MatX exact = dynamics::test::given_stiffness(patches_of(mesh, 20.0, dilatation), x, v);
      const MatX positive = dynamics::test::given_stiffness(
          patches_of(mesh, 20.0, dilatation, Tangent::positive), x, v);
      const auto least = [](const MatX& K) {
        return Eigen::SelfAdjointEigenSolver<MatX>(K).eigenvalues().minCoeff() / K.norm();
      };
      EXPECT_GE(least(positive), -1e-12);
      if (size > 1.0)
        EXPECT_LE((positive - exact).norm(), 1e-12 * exact.norm());
      else
        EXPECT_LT(least(exact), -1e-3);
    }
}
TEST(MeanDilatation, GivesTheStressOfTheLawItReplacesForAHomogeneousDeformation) {
  const Lame lame = lame_from(12.0, 0.45);
  Mat3 F;
  F << 1.2, 0.1, 0, 0.05, 0.9, 0.1, 0, 0.2, 1.1;
  for (const Dilatation dilatation : kAll)
    for (const int nodes : {4, 10}) {
      const TetMesh mesh = some_mesh(nodes);
      const VecX x = test::stacked(mesh.points * F.transpose());
      const MeanDilatation volume = patches_of(mesh, lame.lambda, dilatation);
      const ElasticForce rest(mesh, law_of(dilatation, {0.0, lame.mu}));
      const ElasticForce whole(mesh, law_of(dilatation, lame));
      EXPECT_NEAR(volume.energy(x) + rest.energy(x), whole.energy(x), 1e-11);
      EXPECT_LE((rest.cauchy_stress(x, 3) + volume.cauchy_stress(x)[3] - whole.cauchy_stress(x, 3))
                    .norm(),
                1e-11);
    }
}

/// Force on the upper of two plates bonded to a slab of 2 by 2 by 1 mm, brought together by 0.02
/// mm.
double squeezing_force(const TetMesh& mesh, const std::vector<const dynamics::Force*>& forces) {
  dynamics::Particles particles{test::stacked(mesh.points), VecX::Zero(mesh.points.size()),
                                VecX::Ones(mesh.n_vertices())};
  dynamics::Constraints plates;
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    const double z = mesh.points(i, 2);
    if (z < 1e-9 || z > 1.0 - 1e-9) plates.hold(i);
    if (z > 1.0 - 1e-9) particles.x[3 * i + 2] -= 0.02;
  }
  const SolveReport report =
      dynamics::update_relax(particles, forces, plates,
                             {.tolerance = 1e-6, .linear_solver = dynamics::LinearSolver::ldlt});
  EXPECT_TRUE(report.converged) << report.reason;
  const VecX f = dynamics::total_force(forces, particles.x, VecX::Zero(particles.x.size()));
  double sum = 0.0;
  for (Index i = 0; i < mesh.n_vertices(); ++i)
    if (mesh.points(i, 2) > 1.0 - 1e-9) sum += f[3 * i + 2];
  return sum;
}
TEST(MeanDilatation, SqueezesANearlyIncompressibleSlabWithoutLocking) {
  // elements of ten nodes as the reference
  const Lame lame = lame_from(12.0, 0.495);
  const TetMesh mesh = test::block(4, 4, 2, Vec3::Constant(0.5)), fine = test::with_mid_nodes(mesh);
  const auto force = [&](const TetMesh& body, bool by_patches) {
    const ElasticForce elastic(body, make_corotational({by_patches ? 0.0 : lame.lambda, lame.mu}));
    const MeanDilatation volume = patches_of(body, lame.lambda, Dilatation::stretch_sum);
    return by_patches ? squeezing_force(body, {&elastic, &volume})
                      : squeezing_force(body, {&elastic});
  };
  // two layers of cells are coarse for a slab that bulges so; without patches they are no use
  const double known = force(fine, true);
  EXPECT_NEAR(force(mesh, true), known, 0.45 * known);
  EXPECT_GT(force(mesh, false), 3.0 * known);
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
