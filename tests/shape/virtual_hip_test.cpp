#include <coxa/shape/virtual_hip.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/validate.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

VirtualHip drawn(std::uint64_t seed, const VirtualHipOptions& options = {}) {
  Rng rng(seed);
  return draw_virtual_hip(test::toy_atlas(), rng, options);
}

double rms_difference(const VirtualHip& a, const VirtualHip& b) {
  double sum = 0.0, count = 0.0;
  for (const auto& [name, mesh] : a) {
    sum += (mesh.points - b.at(name).points).squaredNorm();
    count += static_cast<double>(mesh.points.rows());
  }
  return std::sqrt(sum / count);
}

TEST(VirtualHip, IsSoundAndItsCartilagesDoNotEnterEachOther) {
  const VirtualHip hip = drawn(1, {.off_model_rms = 0.5});
  for (const auto& [name, mesh] : hip) EXPECT_TRUE(validate(mesh).valid()) << name;
  const TriMesh& a = hip.at("femoral_cartilage");
  const TriMesh& b = hip.at("acetabular_cartilage");
  const TriangleTree tree(a.points, a.triangles);
  for (Index v = 0; v < b.n_vertices(); ++v)
    EXPECT_GT(tree.signed_distance(b.points.row(v)), -0.05);
}

TEST(VirtualHip, DependsOnTheSeedAlone) {
  EXPECT_EQ(rms_difference(drawn(2), drawn(2)), 0.0);
  EXPECT_GT(rms_difference(drawn(2), drawn(3)), 0.01);
}

TEST(VirtualHip, WithoutSpreadHasTheMeanBones) {
  const VirtualHip hip = drawn(4, {.spread = 0.0}), mean = mean_hip(test::toy_atlas());
  EXPECT_LT((hip.at("femur").points - mean.at("femur").points).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(VirtualHip, LeavesTheModelByTheSizeAskedFor) {
  // over a body of 60 mm a field of 5 mm correlation comes near its mean square
  const VirtualHip before = drawn(5, {.spread = 0.0});
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const VirtualHip hip = drawn(seed, {.spread = 0.0, .off_model_rms = 0.8, .correlation = 8.0});
    sum += std::pow(rms_difference(hip, before), 2);
  }
  EXPECT_NEAR(std::sqrt(sum / 5.0), 0.8, 0.2);
}

TEST(VirtualHip, KeepsTheGapAskedFor) {
  const VirtualHip hip = drawn(6, {.least_gap = 0.6});
  const TriMesh& a = hip.at("femoral_cartilage");
  const TriMesh& b = hip.at("acetabular_cartilage");
  const TriangleTree tree(a.points, a.triangles);
  double least = kInfinity;
  for (Index v = 0; v < b.n_vertices(); ++v)
    least = std::min(least, tree.signed_distance(b.points.row(v)));
  EXPECT_GT(least, 0.25);
}

TEST(VirtualHip, RefusesOptionsOutOfRange) {
  EXPECT_THROW(drawn(1, {.spread = -1.0}), Error);
  EXPECT_THROW(drawn(1, {.off_model_rms = -1.0}), Error);
  EXPECT_THROW(drawn(1, {.correlation = 0.0}), Error);
  EXPECT_THROW(drawn(1, {.least_gap = -0.1}), Error);
  Atlas atlas = test::toy_atlas();
  atlas.structures.pop_back();
  Rng rng(1);
  EXPECT_THROW(draw_virtual_hip(atlas, rng), Error);
}

}  // namespace
}  // namespace coxa::shape
