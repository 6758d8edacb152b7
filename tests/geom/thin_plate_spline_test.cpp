#include <coxa/geom/thin_plate_spline.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TEST(ThinPlateSpline, TakesLandmarksToLandmarks) {
  const Points from = test::random_points(10, 50.0, 1), to = from + test::random_points(10, 5.0, 2);
  EXPECT_LE((ThinPlateSpline(from, to)(from) - to).cwiseAbs().maxCoeff(), 1e-10);
}
TEST(ThinPlateSpline, IsAffineWhereTheLandmarksMoveAffinely) {
  const Points from = test::random_points(9, 50.0, 1);
  Mat3 A;
  A << 1.1, 0.2, -0.1, 0.3, 0.9, 0.05, -0.2, 0.1, 1.3;
  const auto map = [&](const Points& p) {
    return Points((p * A.transpose()).rowwise() + Vec3(4, 5, 6).transpose());
  };
  const Points elsewhere = test::random_points(20, 90.0, 3);
  for (double smoothness : {0.0, 30.0}) {
    const ThinPlateSpline spline(from, map(from), smoothness);
    EXPECT_LE((spline(elsewhere) - map(elsewhere)).cwiseAbs().maxCoeff(), 1e-9);
  }
}
TEST(ThinPlateSpline, SmoothnessMissesNoisyLandmarksAndTendsToTheAffineFit) {
  const Points from = test::random_points(12, 50.0, 1), to = from + test::random_points(12, 5.0, 2);
  double previous = 0.0;
  for (double smoothness : {1.0, 10.0, 100.0}) {
    const double miss = (ThinPlateSpline(from, to, smoothness)(from) - to).norm();
    EXPECT_GT(miss, previous);
    previous = miss;
  }
  const AffineTransform affine = fit_affine(from, to);
  const Vec3 x(10, 20, 30);
  EXPECT_LE((ThinPlateSpline(from, to, 1e9)(x) - affine * x).norm(), 1e-5);
}
TEST(ThinPlateSpline, IsBitIdenticalForOneAndEightThreads) {
  const Points from = test::random_points(10, 50.0, 1), x = test::random_points(1000, 50.0, 3);
  const ThinPlateSpline spline(from, test::random_points(10, 50.0, 2));
  const auto map = [&] { return spline(x); };
  EXPECT_EQ(with_threads(1, map), with_threads(8, map));
}
TEST(ThinPlateSpline, RejectsTooFewCoplanarOrCoincidingLandmarks) {
  const Points flat = test::plate(0.0).points;
  Points twice = test::random_points(6, 10.0, 1);
  twice.row(5) = twice.row(2);
  EXPECT_THROW(ThinPlateSpline(twice.topRows(3), twice.topRows(3)), Error);
  EXPECT_THROW(ThinPlateSpline(flat, flat), Error);
  EXPECT_THROW(ThinPlateSpline(twice, twice), Error);
  EXPECT_THROW(ThinPlateSpline(twice.topRows(5), twice), Error);
  EXPECT_THROW(ThinPlateSpline(twice.topRows(5), twice.topRows(5), -1.0), Error);
}

}  // namespace coxa
