#include <coxa/segment/force_field.h>

#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

const shape::Atlas kAtlas = toy::atlas();
const SimplexHierarchy& hierarchy() { return kAtlas.structures.front().hierarchy; }
const SimplexMesh& finest() { return hierarchy().levels.back(); }
VecX ones() { return VecX::Ones(finest().n_vertices()); }

Points noise(std::uint64_t seed) {
  Rng rng(seed);
  Points field(finest().n_vertices(), 3);
  for (Index v = 0; v < field.rows(); ++v) field.row(v) = rng.normal3().transpose();
  return field;
}

Points affine_field() {
  const Mat3 A = Mat3::Identity() + 0.1 * Vec3(1, 2, 3) * Vec3(1, 0, -1).transpose();
  return (finest().points * A.transpose()).rowwise() + Vec3(1, 2, 3).transpose() - finest().points;
}

}  // namespace

TEST(SmoothedField, KeepsAConstantAndDampsNoise) {
  const Points constant = Vec3(1, 2, 3).transpose().replicate(finest().n_vertices(), 1);
  const Points after = smoothed_field(constant, ones(), finest().neighbours, 5);
  EXPECT_LE((after - constant).cwiseAbs().maxCoeff(), 1e-12);
  const Points field = noise(1);
  EXPECT_LT(smoothed_field(field, ones(), finest().neighbours, 5).norm(), 0.4 * field.norm());
}

TEST(SmoothedField, VerticesWithoutConfidenceTakeTheirNeighboursValues) {
  Points field = Points::Zero(finest().n_vertices(), 3);
  VecX confidence = ones();
  field.row(7) << 100.0, 0.0, 0.0;
  confidence[7] = 0.0;
  EXPECT_LE(smoothed_field(field, confidence, finest().neighbours, 1).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(RegularisedByAffine, KeepsAnAffineFieldWhateverK) {
  for (const double k : {0.0, 0.4, 1.0}) {
    const Points out = regularised_by_affine(finest().points, affine_field(), ones(), k);
    EXPECT_LE((out - affine_field()).cwiseAbs().maxCoeff(), 1e-9) << k;
  }
}

TEST(RegularisedByAffine, BlendsTheFieldWithItsAffinePartByK) {
  const Points field = affine_field() + noise(2);
  const Points pure = regularised_by_affine(finest().points, field, ones(), 0.0);
  EXPECT_LT((pure - affine_field()).norm(), 0.15 * noise(2).norm());
  const Points half = regularised_by_affine(finest().points, field, ones(), 0.5);
  EXPECT_LE((half - 0.5 * (field + pure)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(RegularisedByAffine, IgnoresVerticesWithoutConfidence) {
  Points field = affine_field();
  VecX confidence = ones();
  for (Index v = 0; v < 100; ++v) {
    field.row(v).setConstant(50.0);
    confidence[v] = 0.0;
  }
  const Points out = regularised_by_affine(finest().points, field, confidence, 0.0);
  EXPECT_LE((out - affine_field()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CombinedLevels, KeepsAConstantAndTakesNoiseOutAsTheFineShareFalls) {
  const Points constant = Vec3(1, 2, 3).transpose().replicate(finest().n_vertices(), 1);
  const Points kept = combined_levels(constant, ones(), hierarchy().maps, 0.3);
  EXPECT_LE((kept - constant).cwiseAbs().maxCoeff(), 1e-9);
  double before = kInfinity;
  for (const double share : {1.0, 0.6, 0.2}) {
    const double now = combined_levels(noise(3), ones(), hierarchy().maps, share).norm();
    EXPECT_LT(now, before);
    before = now;
  }
  EXPECT_EQ(combined_levels(noise(3), ones(), hierarchy().maps, 1.0), noise(3));
}

}  // namespace coxa::segment
