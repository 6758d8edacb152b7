#include <coxa/mesh/smooth.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TriMesh noisy_sphere() {
  TriMesh mesh = test::icosphere(4);
  mesh.points += test::random_points(mesh.n_vertices(), 0.1, 3);
  return mesh;
}
double roughness(const TriMesh& mesh) {
  const VecX r = mesh.points.rowwise().norm();
  return std::sqrt((r.array() - r.mean()).square().mean());
}

TEST(Smoothed, TakesNoiseAwayAndKeepsTheVolume) {
  const TriMesh noisy = noisy_sphere(), smooth = smoothed(noisy);
  EXPECT_LT(roughness(smooth), 0.45 * roughness(noisy));
  EXPECT_NEAR(volume(smooth), volume(noisy), 5e-3 * volume(noisy));
}
TEST(Smoothed, WithoutTheStepBackShrinks) {
  const TriMesh sphere = test::icosphere(3);
  EXPECT_LT(volume(smoothed(sphere, {.mu = 0.0})), 0.97 * volume(sphere));
}
TEST(Smoothed, MoreIterationsAndLargerStepsSmoothMore) {
  const TriMesh noisy = noisy_sphere();
  EXPECT_EQ(smoothed(noisy, {.iterations = 0}).points, noisy.points);
  EXPECT_LT(roughness(smoothed(noisy, {.iterations = 20})),
            roughness(smoothed(noisy, {.iterations = 3})));
  EXPECT_LT(roughness(smoothed(noisy, {.lambda = 0.5, .mu = 0.0})),
            roughness(smoothed(noisy, {.lambda = 0.1, .mu = 0.0})));
}
TEST(Smoothed, KeepsTheBorder) {
  TriMesh plate = test::plate(0.0, 1.0, 4);
  plate.points.col(2) = test::random_points(plate.n_vertices(), 0.1, 1).col(0);
  const TriMesh smooth = smoothed(plate);
  for (Index v = 0; v < plate.n_vertices(); ++v) {
    const bool border = plate.points.row(v).head<2>().cwiseAbs().maxCoeff() > 0.99;
    EXPECT_EQ(border, smooth.points.row(v) == plate.points.row(v));
  }
}
TEST(Smoothed, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] { return smoothed(noisy_sphere()).points; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(Smoothed, RejectsBadOptions) {
  EXPECT_THROW(smoothed(test::box(), {.iterations = -1}), Error);
  EXPECT_THROW(smoothed(test::box(), {.lambda = 1.5}), Error);
  EXPECT_THROW(smoothed(test::box(), {.mu = 0.5}), Error);
}

}  // namespace coxa
