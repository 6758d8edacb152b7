#include "../../src/motion/weighted_rotation.h"

#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "../../src/motion/artefact_model.h"

namespace coxa::motion {
namespace {

Points some_markers(Index n, Rng& rng) {
  Points x(n, 3);
  for (Index m = 0; m < n; ++m)
    x.row(m) = Vec3(0, -200, 0) + Vec3(60, 90, 60).cwiseProduct(rng.normal3());
  return x;
}
AxisCovariance some_covariance(Index n, Rng& rng) {
  AxisCovariance V;
  for (MatX& axis : V) {
    const MatX A = MatX::NullaryExpr(n, n, [&] { return rng.normal(); });
    axis = A * A.transpose() + MatX::Identity(n, n);
  }
  return V;
}

}  // namespace

TEST(WeightedRotation, WithEqualWeightsIsTheNearestRotation) {
  Rng rng(1);
  const Points x = some_markers(7, rng);
  const Mat3 R = rotation_from_vector(Vec3(0.4, -0.3, 1.2));
  Points y = x * R.transpose();
  for (Index m = 0; m < 7; ++m) y.row(m) += 8.0 * rng.normal3();
  const WeightedRotation fit(x, same_along_all_axes(MatX::Identity(7, 7)));
  EXPECT_LE((fit.solve(y, R) - nearest_rotation(y.transpose() * x)).norm(), 1e-9);
}
TEST(WeightedRotation, GainIsTheDerivativeOfTheSolution) {
  Rng rng(2);
  const Points x = some_markers(6, rng);
  const WeightedRotation fit(x, some_covariance(6, rng));
  const Mat3 R = rotation_from_vector(Vec3(-0.8, 0.2, 0.5));
  const Points y = x * R.transpose();
  constexpr double kStep = 1e-4;  // mm
  for (Index m = 0; m < 6; ++m) {
    for (int axis = 0; axis < 3; ++axis) {
      Points plus = y, minus = y;
      plus.row(m) += kStep * R.col(axis).transpose();
      minus.row(m) -= kStep * R.col(axis).transpose();
      const Mat3 A = fit.solve(plus, R), B = fit.solve(minus, R);
      const Vec3 change = rotation_vector(B.transpose() * A) / (2.0 * kStep);
      EXPECT_LE((change - fit.gain()[static_cast<std::size_t>(axis)].col(m)).norm(), 1e-9);
    }
  }
}
TEST(WeightedRotation, SpreadsAsItsCovarianceSays) {
  // brute force: 4000 draws of errors with the covariance that the fit assumes
  Rng rng(3);
  const Points x = some_markers(5, rng);
  const AxisCovariance V = some_covariance(5, rng);
  const WeightedRotation fit(x, V);
  Mat3 seen = Mat3::Zero();
  constexpr int kDraws = 4000;
  for (int draw = 0; draw < kDraws; ++draw) {
    Points y = x;
    for (int axis = 0; axis < 3; ++axis) {
      const MatX L = V[static_cast<std::size_t>(axis)].llt().matrixL();
      y.col(axis) += L * VecX::NullaryExpr(5, [&] { return rng.normal(); });
    }
    const Vec3 w = rotation_vector(fit.solve(y, Mat3::Identity()));
    seen += w * w.transpose() / kDraws;
  }
  // a variance from 4000 draws is good to 2 % (one SD)
  EXPECT_LE((seen - fit.propagated(V)).norm(), 0.1 * fit.propagated(V).norm());
  EXPECT_LE((fit.inverse_information() - fit.propagated(V)).norm(),
            1e-9 * fit.propagated(V).norm());
}
TEST(WeightedRotation, AFreeShiftLeavesNoShiftGain) {
  Rng rng(4);
  const Points x = some_markers(6, rng);
  AxisCovariance weights = WeightedRotation(x, some_covariance(6, rng)).weights();
  for (MatX& W : weights) {
    const VecX s = W.rowwise().sum();
    W -= s * s.transpose() / s.sum();
  }
  EXPECT_LE(WeightedRotation::from_weights(x, weights).shift_gain().norm(), 1e-9);
}

TEST(ArtefactModel, FindsWhichMarkersAndAxesMoveMost) {
  // 400 frames of artefact drawn from the model's own covariance with logarithms of sizes spread
  Rng rng(5);
  ThighObservations thigh;
  const Index K = 10, n = 400;
  thigh.x = some_markers(K, rng);
  thigh.seen = MatX::Ones(n, K);
  ArtefactModel truth{.marker = VecX(K), .axis = Vec3(2.0, 1.0, 0.5)};
  for (Index m = 0; m < K; ++m) truth.marker[m] = m % 2 == 0 ? 4.0 : 64.0;
  const AxisCovariance V = truth.covariance();
  for (Index f = 0; f < n; ++f) {
    Points local = thigh.x;
    for (int axis = 0; axis < 3; ++axis) {
      const MatX L = V[static_cast<std::size_t>(axis)].llt().matrixL();
      local.col(axis) += L * VecX::NullaryExpr(K, [&] { return rng.normal(); });
    }
    thigh.y.push_back(local * rotation_from_vector(0.5 * rng.normal3()).transpose());
  }
  const ArtefactModel found = estimate_artefact(thigh, {.marker = 0.1});
  EXPECT_TRUE(found.converged);
  // drawn towards the mean of logarithms, 16 mm², in rounds that each keep 0.7: never past it
  for (Index m = 0; m < K; ++m) {
    EXPECT_GT(found.marker[m], m % 2 == 0 ? 3.0 : 20.0);
    EXPECT_LT(found.marker[m], m % 2 == 0 ? 13.0 : 80.0);
  }
  EXPECT_GT(found.axis.x(), found.axis.y());
  EXPECT_GT(found.axis.y(), found.axis.z());
  EXPECT_NEAR(found.axis.prod(), 1.0, 1e-9);
}
TEST(ArtefactModel, CovarianceIsPositiveAndSharesAThird) {
  ArtefactModel model{.marker = VecX::Constant(4, 9.0)};
  const MatX V = model.covariance()[1];
  EXPECT_NEAR(V(0, 0), 9.0 * 1.5, 1e-12);
  EXPECT_NEAR(V(0, 1) / V(0, 0), 1.0 / 3.0, 1e-12);
  EXPECT_GT(V.llt().matrixL().determinant(), 0.0);
}

}  // namespace coxa::motion
