#include <coxa/fem/viscoelastic_force.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

const Lame kCartilage = lame_from(12.0, 0.42);
const std::vector<PronyTerm> kTerms{{.share = 0.3, .time = 0.2}, {.share = 0.4, .time = 5.0}};

struct Block {
  TetMesh mesh = test::shaken(test::block(1, 1, 1, Vec3::Ones()), 0.1);
  ViscoelasticForce force{mesh, make_st_venant_kirchhoff(kCartilage), kTerms};
  ElasticForce elastic{mesh, make_st_venant_kirchhoff(kCartilage)};
  VecX rest = test::stacked(mesh.points), v = VecX::Zero(rest.size());
  VecX some(double size, std::uint64_t seed) const {
    Rng rng(seed);
    VecX x = rest;
    for (double& value : x) value += size * rng.normal();
    return x;
  }
};

TEST(ViscoelasticForce, StartsAsTheInstantaneousLaw) {
  const Block b;
  const VecX x = b.some(0.05, 1);
  EXPECT_LE(
      (dynamics::test::force_at(b.force, x, b.v) - dynamics::test::force_at(b.elastic, x, b.v))
          .norm(),
      1e-13);
}
TEST(ViscoelasticForce, RelaxesAsTheSeriesSaysForAnyStepAfterAStepOfStrain) {
  for (const int steps : {1, 3, 17}) {
    Block b;
    const VecX x = b.some(0.05, 1);
    b.force.begin_step(0.0);
    b.force.end_step(x);
    const double t = 2.0;
    for (int k = 0; k < steps; ++k) {
      b.force.begin_step(t / steps);
      b.force.end_step(x);
    }
    const double left = 0.3 + 0.3 * std::exp(-t / 0.2) + 0.4 * std::exp(-t / 5.0);
    const VecX elastic = dynamics::test::force_at(b.elastic, x, b.v);
    EXPECT_LE((dynamics::test::force_at(b.force, x, b.v) - left * elastic).norm(),
              1e-12 * elastic.norm());
    EXPECT_LE((b.force.cauchy_stress(x, 2) - left * b.elastic.cauchy_stress(x, 2)).norm(), 1e-12);
  }
}
TEST(ViscoelasticForce, KeepsOnlyTheRestForEver) {
  Block b;
  const VecX x = b.some(0.05, 1);
  b.force.begin_step(1e6);
  b.force.end_step(x);
  b.force.begin_step(1e6);
  EXPECT_LE((dynamics::test::force_at(b.force, x, b.v) -
             0.3 * dynamics::test::force_at(b.elastic, x, b.v))
                .norm(),
            1e-5);
}
TEST(ViscoelasticForce, HasTheForceOfItsPotentialAndItsJacobian) {
  Block b;
  b.force.begin_step(0.3);
  b.force.end_step(b.some(0.05, 1));
  b.force.begin_step(0.4);
  const VecX x = b.some(0.05, 2);
  const VecX f = dynamics::test::force_at(b.force, x, b.v);
  EXPECT_LE((f - dynamics::test::numeric_force(b.force, x)).norm(), 1e-8);
  const MatX K = dynamics::test::given_stiffness(b.force, x, b.v);
  EXPECT_LE((K - dynamics::test::numeric_stiffness(b.force, x, b.v)).norm(), 1e-8 * K.norm());
}
TEST(ViscoelasticForce, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] {
    Block b;
    b.force.begin_step(0.3);
    b.force.end_step(b.some(0.05, 1));
    b.force.begin_step(0.4);
    return dynamics::test::force_at(b.force, b.some(0.05, 2), b.v);
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(ViscoelasticForce, RejectsImpossibleSeriesAndSteps) {
  const TetMesh mesh = test::block(1, 1, 1, Vec3::Ones());
  const auto make = [&](std::vector<PronyTerm> terms) {
    return ViscoelasticForce(mesh, make_st_venant_kirchhoff(kCartilage), std::move(terms));
  };
  EXPECT_THROW(make({{.share = 0.6, .time = 1.0}, {.share = 0.5, .time = 2.0}}), Error);
  EXPECT_THROW(make({{.share = 0.0, .time = 1.0}}), Error);
  EXPECT_THROW(make({{.share = 0.5, .time = 0.0}}), Error);
  Block b;
  EXPECT_THROW(b.force.begin_step(-1.0), Error);
}

}  // namespace coxa::fem
