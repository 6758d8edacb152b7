#include <coxa/geom/fits.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <Eigen/Dense>

namespace coxa {

// points of a spherical cap of the given half angle about +z
Points cap(const Vec3& centre, double radius, double half_angle, Index n, double noise) {
  Rng rng(7);
  Points points(n, 3);
  for (Index i = 0; i < n; ++i) {
    const double z = rng.uniform(std::cos(half_angle), 1.0), a = rng.uniform(0.0, 2.0 * kPi),
                 s = std::sqrt(1 - z * z);
    points.row(i) =
        centre + (radius + noise * rng.normal()) * Vec3(s * std::cos(a), s * std::sin(a), z);
  }
  return points;
}
double sum_of_squares(const Points& points, const Vec3& centre, double radius) {
  return ((points.rowwise() - centre.transpose()).rowwise().norm().array() - radius).square().sum();
}

TEST(FitSphere, RecoversAnExactCap) {
  const Sphere sphere = fit_sphere(cap(Vec3(100, -50, 20), 24.0, 0.6, 50, 0.0));
  EXPECT_LE((sphere.centre - Vec3(100, -50, 20)).norm(), 1e-10);
  EXPECT_NEAR(sphere.radius, 24.0, 1e-10);
  EXPECT_LE(sphere.rms, 1e-10);
}
TEST(FitSphere, IsAMinimumOfTheGeometricResidual) {
  const Points points = cap(Vec3(1, 2, 3), 24.0, 1.0, 200, 0.5);
  const Sphere sphere = fit_sphere(points);
  const double best = sum_of_squares(points, sphere.centre, sphere.radius);
  EXPECT_NEAR(sphere.rms, std::sqrt(best / 200), 1e-12);
  for (int k = 0; k < 4; ++k)
    for (double step : {-1e-3, 1e-3}) {
      const Vec3 centre =
          sphere.centre + (k < 3 ? Vec3(step * Vec3::Unit(k % 3)) : Vec3(Vec3::Zero()));
      EXPECT_GT(sum_of_squares(points, centre, sphere.radius + (k == 3 ? step : 0.0)), best);
    }
}
TEST(FitSphere, RobustFitIgnoresOutliersThatPullThePlainFit) {
  Points points = cap(Vec3(1, 2, 3), 24.0, 1.2, 200, 0.05);
  for (Index i = 0; i < 40; ++i) points.row(i) += Vec3(0, 0, 6.0).transpose();
  EXPECT_GT((fit_sphere(points).centre - Vec3(1, 2, 3)).norm(), 0.5);
  EXPECT_LT((fit_sphere(points, {}, {.outlier_scale = 4.7}).centre - Vec3(1, 2, 3)).norm(), 0.05);
}
TEST(FitSphere, WeightZeroRemovesAPoint) {
  Points points = cap(Vec3(1, 2, 3), 24.0, 1.2, 30, 0.0);
  points.row(4) << 90, 90, 90;
  VecX weights = VecX::Ones(30);
  weights[4] = 0.0;
  EXPECT_LE((fit_sphere(points, weights).centre - Vec3(1, 2, 3)).norm(), 1e-10);
}
TEST(FitSphere, RejectsPlanesTooFewPointsAndBadWeights) {
  EXPECT_THROW(fit_sphere(test::plate(3.0).points), Error);
  EXPECT_THROW(fit_sphere(test::random_points(3, 1.0, 1)), Error);
  EXPECT_THROW(fit_sphere(test::random_points(9, 1.0, 1), VecX::Ones(8)), Error);
  EXPECT_THROW(fit_sphere(test::random_points(9, 1.0, 1), -VecX::Ones(9)), Error);
  EXPECT_THROW(fit_sphere(test::random_points(9, 1.0, 1), {}, {.outlier_scale = -1.0}), Error);
}
TEST(FitPlane, RecoversATiltedPlane) {
  const RigidTransform X = test::some_pose();
  const Plane plane = fit_plane(transformed(test::plate(0.0).points, X));
  EXPECT_NEAR(std::abs(plane.normal.dot(X.R.col(2))), 1.0, 1e-14);
  EXPECT_LE((plane.point - X.p).norm(), 1e-12);
  EXPECT_THROW(fit_plane((Points(3, 3) << 0, 0, 0, 1, 1, 1, 2, 2, 2).finished()), Error);
}
TEST(FitLine, RecoversALine) {
  const Vec3 direction = Vec3(1, 2, -2) / 3.0;
  Points points(9, 3);
  for (Index i = 0; i < 9; ++i) points.row(i) = Vec3(5, 6, 7) + (i - 4.0) * direction;
  const Line line = fit_line(points);
  EXPECT_NEAR(std::abs(line.direction.dot(direction)), 1.0, 1e-14);
  EXPECT_LE((line.point - Vec3(5, 6, 7)).norm(), 1e-13);
  EXPECT_THROW(fit_line(Points::Ones(2, 3)), Error);
}
TEST(FitRigid, RecoversAPoseAndNeverReflects) {
  const Points a = test::random_points(12, 30.0, 3);
  const RigidTransform X = test::some_pose(), found = fit_rigid(a, transformed(a, X));
  EXPECT_LE((found.R - X.R).norm(), 1e-13);
  EXPECT_LE((found.p - X.p).norm(), 1e-12);
  Points mirrored = a;
  mirrored.col(0) *= -1.0;
  EXPECT_NEAR(fit_rigid(a, mirrored).R.determinant(), 1.0, 1e-12);
}
TEST(FitRigid, WorksForThreePointsAndRespectsWeights) {
  const RigidTransform X = test::some_pose();
  Points a = test::random_points(4, 30.0, 3), b = transformed(a, X);
  b.row(3).array() += 50.0;
  EXPECT_LE((fit_rigid(a, b, (VecX(4) << 1, 1, 1, 0).finished()).R - X.R).norm(), 1e-12);
  EXPECT_LE((fit_rigid(a.topRows(3), b.topRows(3)).R - X.R).norm(), 1e-12);
  EXPECT_GT((fit_rigid(a, b).R - X.R).norm(), 1e-2);
  EXPECT_THROW(fit_rigid(a.topRows(2), b.topRows(2)), Error);
  EXPECT_THROW(fit_rigid(a, b.topRows(3)), Error);
}
TEST(FitRigid, IsAMinimumForNoisyPoints) {
  const Points a = test::random_points(20, 30.0, 3);
  const Points b = transformed(a, test::some_pose()) + test::random_points(20, 2.0, 4);
  const RigidTransform X = fit_rigid(a, b);
  const double best = (transformed(a, X) - b).squaredNorm();
  for (int k = 0; k < 3; ++k) {
    const Vec3 step = 1e-3 * Vec3::Unit(k);
    EXPECT_GT((transformed(a, {rotation_from_vector(step) * X.R, X.p}) - b).squaredNorm(), best);
    EXPECT_GT((transformed(a, {X.R, X.p + step}) - b).squaredNorm(), best);
  }
}
TEST(FitSimilarity, RecoversScaleAndIsLeastSquares) {
  const Points a = test::random_points(12, 30.0, 3);
  const RigidTransform X = test::some_pose();
  const Similarity exact = fit_similarity(a, transformed(1.7 * a, X));
  EXPECT_NEAR(exact.scale, 1.7, 1e-13);
  EXPECT_LE((exact.X.R - X.R).norm() + (exact.X.p - X.p).norm(), 1e-12);
  const Points b = transformed(1.7 * a, X) + test::random_points(12, 3.0, 8);
  const Similarity s = fit_similarity(a, b);
  const auto residual = [&](double scale) {
    return (transformed(scale * a, s.X) - b).squaredNorm();
  };
  EXPECT_GT(residual(s.scale + 1e-4), residual(s.scale));
  EXPECT_GT(residual(s.scale - 1e-4), residual(s.scale));
}
TEST(FitAffine, RecoversAnAffineMapAndRejectsAPlane) {
  const Points a = test::random_points(8, 30.0, 3);
  Mat3 A;
  A << 1.1, 0.2, -0.1, 0.3, 0.9, 0.05, -0.2, 0.1, 1.3;
  const Points b = (a * A.transpose()).rowwise() + Vec3(4, 5, 6).transpose();
  const AffineTransform found = fit_affine(a, b);
  EXPECT_LE((found.A - A).norm() + (found.t - Vec3(4, 5, 6)).norm(), 1e-12);
  EXPECT_LE((found * Vec3(a.row(2)) - Vec3(b.row(2))).norm(), 1e-12);
  EXPECT_THROW(fit_affine(test::plate(1.0).points, test::plate(2.0).points), Error);
}
TEST(RotationVector, RoundTripsAtEveryAngle) {
  const Vec3 axis = Vec3(1, -2, 3).normalized();
  for (double angle : {0.0, 1e-12, 1e-8, 1e-4, 0.5, 2.0, kPi - 1e-9}) {
    const Mat3 R = rotation_from_vector(angle * axis);
    EXPECT_LE((R * R.transpose() - Mat3::Identity()).norm(), 1e-14);
    EXPECT_LE((R - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 1e-14);
    EXPECT_LE((rotation_vector(R) - angle * axis).norm(), 1e-13);
  }
  EXPECT_NEAR(rotation_vector(rotation_from_vector(kPi * axis)).norm(), kPi, 1e-12);
}

}  // namespace coxa
