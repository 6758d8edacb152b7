#include <coxa/shape/shape_modes.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

const TriMesh kMean = test::ellipsoid(Vec3(1.2, 1.0, 0.8));

/// The mean with a bulge along x where x > 0, `size` mm high.
Points bulged(double size) {
  Points points = kMean.points;
  for (Index v = 0; v < points.rows(); ++v)
    points(v, 0) +=
        size * std::exp(-0.1 * (points.row(v) - Vec3(12, 0, 0).transpose()).squaredNorm());
  return points;
}

std::vector<Points> bulged_family() {
  std::vector<Points> shapes;
  for (const double size : {-1.5, -0.5, 0.0, 0.5, 1.5}) shapes.push_back(bulged(size));
  return shapes;
}

TEST(ShapeModes, FindsTheOnlyWayAFamilyVaries) {
  const ShapeModes modes = principal_modes(align_shapes(bulged_family()), 0.98);
  ASSERT_EQ(modes.deviations.size(), 1);
  // coefficients -1.5 … 1.5 have standard deviation sqrt(5/4) times the bulge's norm
  const double norm = (bulged(1.0) - bulged(0.0)).norm();
  EXPECT_NEAR(modes.deviations[0], std::sqrt(1.25) * norm, 0.1 * norm);
  EXPECT_NEAR(modes.modes.col(0).norm(), 1.0, 1e-12);
}

TEST(ShapeModes, AreOrthonormal) {
  Rng rng(3);
  std::vector<Points> shapes;
  for (int i = 0; i < 6; ++i) {
    Points shape = kMean.points;
    for (Index v = 0; v < shape.rows(); ++v) shape.row(v) += 0.2 * rng.normal3().transpose();
    shapes.push_back(shape);
  }
  const ShapeModes modes = principal_modes(align_shapes(shapes), 1.0);
  const MatX product = modes.modes.transpose() * modes.modes;
  EXPECT_LT((product - MatX::Identity(product.rows(), product.cols())).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ShapeModes, DoNotSeePoseAndSize) {
  std::vector<Points> shapes = bulged_family();
  const double before = principal_modes(align_shapes(shapes), 0.98).deviations[0];
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double angle = 0.1 * static_cast<double>(i) - 0.2;
    const Mat3 R = rotation_from_vector(angle * Vec3(0.3, 0.5, -0.8));
    shapes[i] = shapes[i] * R.transpose();
    shapes[i].rowwise() += Vec3(1.0, 2.0, -3.0).transpose() * angle;
  }
  const ShapeModes modes = principal_modes(align_shapes(shapes), 0.98);
  ASSERT_EQ(modes.deviations.size(), 1);
  // the average of turned shapes, which gives the size, is a little smaller
  EXPECT_NEAR(modes.deviations[0], before, 0.01 * before);
}

TEST(ShapeModes, AlignOnTheVerticesThatCount) {
  // one half is bent away in the second shape; with all weight on the other half it fits exactly
  std::vector<Points> shapes = {kMean.points, kMean.points};
  VecX weights(kMean.n_vertices());
  for (Index v = 0; v < kMean.n_vertices(); ++v) {
    weights[v] = kMean.points(v, 2) > 0.0 ? 1.0 : 0.0;
    if (weights[v] == 0.0) shapes[1](v, 0) += 3.0;
  }
  const AlignedShapes aligned = align_shapes(shapes, weights);
  for (Index v = 0; v < kMean.n_vertices(); ++v) {
    if (weights[v] == 0.0) continue;
    EXPECT_LT((aligned.shapes[0].row(v) - aligned.shapes[1].row(v)).norm(), 1e-9);
  }
}

TEST(ShapeModes, LeaveOneOutErrorIsSmallForAFamilyOfOneMode) {
  const std::vector<double> errors = leave_one_out_errors(align_shapes(bulged_family()));
  ASSERT_EQ(errors.size(), 5u);
  for (const double error : errors) EXPECT_LT(error, 0.02);
  EXPECT_TRUE(leave_one_out_errors(align_shapes({kMean.points, bulged(1.0)})).empty());
}

TEST(ShapeModes, LeaveOneOutErrorShowsWhatTheOthersDoNotKnow) {
  std::vector<Points> shapes(4, kMean.points);
  shapes[3] = bulged(2.0);
  const std::vector<double> errors = leave_one_out_errors(align_shapes(shapes));
  EXPECT_GT(errors[3], 0.1);
}

TEST(ShapeModes, ShapeFromAddsDeviationsTimesModes) {
  const AlignedShapes aligned = align_shapes(bulged_family());
  const ShapeModes modes = principal_modes(aligned, 0.98);
  const Points moved = shape_from(aligned.mean, modes, VecX::Constant(1, 2.0));
  EXPECT_NEAR((moved - aligned.mean).norm(), 2.0 * modes.deviations[0], 1e-9);
  EXPECT_EQ(shape_from(aligned.mean, modes, VecX()), aligned.mean);
  EXPECT_THROW(shape_from(aligned.mean, modes, VecX::Zero(2)), Error);
}

TEST(ShapeModes, RefuseShapesThatDoNotCorrespond) {
  EXPECT_THROW(align_shapes({}), Error);
  EXPECT_THROW(align_shapes({kMean.points, Points(kMean.points.topRows(10))}), Error);
  EXPECT_THROW(principal_modes(align_shapes(bulged_family()), 0.0), Error);
}

}  // namespace
}  // namespace coxa::shape
