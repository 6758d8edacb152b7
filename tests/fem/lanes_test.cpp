#include "../../src/fem/lanes.h"

#include <coxa/core/rng.h>
#include <gtest/gtest.h>

namespace coxa::fem {
namespace {

const Lame kCartilage = lame_from(12.0, 0.42);

Mat3 random_matrix(Rng& rng, double size) {
  Mat3 F = Mat3::Identity();
  for (int i = 0; i < 9; ++i) F(i / 3, i % 3) += size * rng.normal();
  return F;
}

/// What a law says of four matrices side by side and of each alone.
void expect_same(const Material& law, const std::array<Mat3, kLanes>& matrices) {
  LaneMat3 F, P;
  double energy[kLanes];
  for (int lane = 0; lane < kLanes; ++lane)
    set_matrix(F, lane, matrices[static_cast<std::size_t>(lane)]);
  law.energies_with_piolas(F, P, energy);
  for (int lane = 0; lane < kLanes; ++lane) {
    Mat3 stress;
    const double alone = law.energy_with_piola(matrices[static_cast<std::size_t>(lane)], stress);
    EXPECT_NEAR(energy[lane], alone, 1e-12 * (1.0 + std::abs(alone)));
    EXPECT_LE((matrix_of(P, lane) - stress).norm(), 1e-11 * (1.0 + stress.norm()));
  }
}

}  // namespace

TEST(Lanes, AgreeWithOneElementAtATime) {
  Rng rng(5);
  const auto corotational = make_corotational(kCartilage);
  const auto compacting = make_compacting(make_corotational(kCartilage), {0.25, 3000.0});
  const auto neo_hookean = make_neo_hookean(kCartilage);
  for (int k = 0; k < 200; ++k) {
    // from hardly strained to turned inside out
    const double size = 0.01 * k;
    const std::array<Mat3, kLanes> F = {random_matrix(rng, size), random_matrix(rng, size),
                                        random_matrix(rng, 0.1), random_matrix(rng, size)};
    expect_same(*corotational, F);
    expect_same(*compacting, F);
    if (size < 0.1) expect_same(*neo_hookean, F);
  }
}
TEST(Lanes, LeaveFlatElementsToTheSingularValues) {
  const Mat3 flat = Vec3(1.0, 0.01, -0.01).asDiagonal();
  LaneMat3 F, R;
  for (int lane = 0; lane < kLanes; ++lane) set_matrix(F, lane, Mat3::Identity());
  set_matrix(F, 2, flat);
  EXPECT_EQ(polar_rotations(F, R), 1U << 2);
  expect_same(*make_corotational(kCartilage),
              {Mat3::Identity(), 1.1 * Mat3::Identity(), flat, Mat3(0.9 * Mat3::Identity())});
}

}  // namespace coxa::fem
