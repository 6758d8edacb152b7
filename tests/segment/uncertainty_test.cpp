#include <coxa/segment/uncertainty.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace coxa::segment {
namespace {

/// 41 × 41 × 21 voxels of 1 × 1 × 2 mm about the origin, turned a quarter about z.
Volume box() {
  Volume volume;
  volume.size = {41, 41, 21};
  volume.spacing = Vec3(1.0, 1.0, 2.0);
  volume.direction.col(0) = Vec3::UnitY();
  volume.direction.col(1) = -Vec3::UnitX();
  volume.origin = Vec3(20.0, -20.0, -20.0);
  return volume;
}

TEST(Uncertainty, EvidenceOfPlaceSeesTheBoxAndTheVoxels) {
  TriMesh ball = test::icosphere(3, 10.0);
  const Volume volume = box();
  const Volume* const images[] = {&volume};
  Index top = 0;
  ball.points.col(2).maxCoeff(&top);
  const Evidence inside = evidence_of_place(ball, 0, images);
  EXPECT_NEAR(inside.view_depth[top], 20.0 - ball.points(top, 2), 1e-9);
  EXPECT_NEAR(inside.half_voxel[top], 1.0, 0.02);  // half of 2 mm
  EXPECT_TRUE(std::isinf(inside.rim_distance[top]));
  ball.points.col(0).array() += 33.0;
  ball.points.col(1).array() += 24.0;
  const Evidence outside = evidence_of_place(ball, 0, images);
  EXPECT_NEAR(outside.view_depth[top], -std::hypot(13.0, 4.0), 0.1);
}
TEST(Uncertainty, LayersHaveTwoSidesAndARim) {
  const TriMesh plate = test::plate(0.0, 10.0, 10);
  // the same plate from below, sharing its border
  TriMesh layer = test::turned_over(plate);
  const Index n = plate.n_vertices();
  std::vector<Index> above(static_cast<std::size_t>(n));
  std::vector<Index> inner;
  for (Index v = 0; v < n; ++v) {
    const bool border = plate.points.row(v).head(2).cwiseAbs().maxCoeff() > 9.9;
    above[static_cast<std::size_t>(v)] = border ? v : n + static_cast<Index>(inner.size());
    if (!border) inner.push_back(v);
  }
  layer.points.conservativeResize(n + static_cast<Index>(inner.size()), 3);
  for (std::size_t i = 0; i < inner.size(); ++i)
    layer.points.row(n + static_cast<Index>(i)) =
        plate.points.row(inner[i]) + Vec3::UnitZ().transpose();
  layer.triangles.conservativeResize(2 * plate.n_triangles(), 3);
  for (Index t = 0; t < plate.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k)
      layer.triangles(plate.n_triangles() + t, k) =
          above[static_cast<std::size_t>(plate.triangles(t, k))];
  const Volume volume = box();
  const Volume* const images[] = {&volume};
  const Evidence evidence = evidence_of_place(layer, plate.n_triangles(), images);
  const Index middle = n / 2;
  ASSERT_NEAR(layer.points.row(middle).norm(), 0.0, 1e-9);
  EXPECT_NEAR(evidence.rim_distance[middle], 10.0, 1e-9);
  EXPECT_EQ(evidence.far_side[middle], 0.0);
  const Index far = above[static_cast<std::size_t>(middle)];
  EXPECT_EQ(evidence.far_side[far], 1.0);
  EXPECT_NEAR(evidence.rim_distance[far], std::sqrt(101.0), 1e-9);
  EXPECT_EQ(evidence.rim_distance[0], 0.0);
}
TEST(Uncertainty, IsWhatItsFormulaSays) {
  Evidence evidence;
  evidence.confidence = Vec2(0.8, 0.8);
  evidence.border_deviation = Vec2(0.5, 0.5);
  evidence.view_depth = Vec2(4.0, -10.0);
  evidence.half_voxel = Vec2(0.8, 0.8);
  evidence.rim_distance = Vec2(3.0, 3.0);
  evidence.far_side = Vec2(1.0, 1.0);
  const Calibration c{.constant = -1.0,
                      .doubt = 2.0,
                      .border = 0.5,
                      .edge = 0.7,
                      .blur = 1.0,
                      .rim = 0.6,
                      .far_side = 0.3,
                      .beyond = 1.0,
                      .growth = 0.5};
  const VecX half_width = uncertainties(evidence, c);
  const double expected = -1.0 + 2.0 * 0.2 + 0.5 * std::log(0.5) + 0.7 * std::exp(-1.0) +
                          std::log(2.0) + 0.6 * std::exp(-1.0) + 0.3;
  EXPECT_NEAR(half_width[0], std::exp(expected), 1e-12);
  EXPECT_NEAR(half_width[1], std::exp(1.0 + 0.5 * std::log(3.0)), 1e-12);
}

}  // namespace
}  // namespace coxa::segment
