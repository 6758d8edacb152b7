#include <coxa/segment/smooth_modes.h>

#include <coxa/core/error.h>
#include <coxa/segment/model_fit.h>

#include <gtest/gtest.h>

#include <cmath>

#include "toy.h"

namespace coxa::segment {
namespace {

Points egg() { return toy::points_of({}, 3); }

TEST(SmoothModes, HaveTheCovarianceAskedFor) {
  const Points points = egg();
  const SmoothModes modes = smooth_modes(points, {.deviation = 2.0, .length = 20.0});
  const MatX covariance = modes.moves * modes.moves.transpose();
  double worst = 0.0;
  for (Index i = 0; i < points.rows(); i += 37) {
    for (Index j = 0; j < points.rows(); j += 41) {
      const double d = (points.row(i) - points.row(j)).norm() / 20.0;
      worst = std::max(worst, std::abs(covariance(i, j) - 4.0 * std::exp(-0.5 * d * d)));
    }
  }
  EXPECT_LT(worst, 0.3);  // of 4
}

TEST(SmoothModes, NoneWithoutDeviation) {
  EXPECT_EQ(smooth_modes(egg(), {.deviation = 0.0, .length = 20.0}).moves.cols(), 0);
}

TEST(SmoothModes, JoinedAddsVariances) {
  const SmoothModes a = smooth_modes(egg(), {.deviation = 2.0, .length = 30.0}),
                    b = smooth_modes(egg(), {.deviation = 1.0, .length = 15.0});
  const SmoothModes both = joined(a, b);
  EXPECT_NEAR(both.moves.row(5).squaredNorm(),
              a.moves.row(5).squaredNorm() + b.moves.row(5).squaredNorm(), 1e-12);
}

TEST(SmoothModes, FitFollowsABulgeThatNoModeKnows) {
  const shape::StructureModel model = toy::atlas().structures.front();
  const Points& mean = model.hierarchy.levels.back().points;
  Points targets = mean;
  for (Index v = 0; v < targets.rows(); ++v) {
    const double d = (mean.row(v) - mean.row(100)).norm();
    targets.row(v) += 4.0 * std::exp(-0.5 * std::pow(d / 15.0, 2)) * mean.row(v).normalized();
  }
  const VecX ones = VecX::Ones(targets.rows());
  const SmoothModes smooth = smooth_modes(mean, {.deviation = 2.0, .length = 15.0});
  const ModelFit stiff = fit_model(model, targets, ones, 0.5),
                 soft = fit_model(model, targets, ones, 0.5, &smooth);
  const auto error = [&](const ModelFit& fit) {
    return (fit.points - targets).rowwise().norm().mean();
  };
  EXPECT_GT(error(stiff), 0.3);
  EXPECT_LT(error(soft), 0.1);
  EXPECT_EQ(stiff.off_model, 0.0);
  EXPECT_GT(soft.off_model, 0.1);
}

TEST(SmoothModes, UnseenPartStaysWithTheModel) {
  const shape::StructureModel model = toy::atlas().structures.front();
  const Points& mean = model.hierarchy.levels.back().points;
  VecX weights = (mean.col(2).array() > 0.0).cast<double>();
  Points targets = mean;
  for (Index v = 0; v < targets.rows(); ++v) {
    if (weights[v] == 0.0) targets.row(v) += Vec3(5.0, -3.0, 2.0).transpose();
  }
  const SmoothModes smooth = smooth_modes(mean, {.deviation = 2.0, .length = 15.0});
  const ModelFit fit = fit_model(model, targets, weights, 0.5, &smooth);
  EXPECT_LT((fit.points - mean).rowwise().norm().maxCoeff(), 0.01);
}

TEST(SmoothModes, RefusesNonsense) {
  EXPECT_THROW(smooth_modes(egg(), {.deviation = -1.0, .length = 20.0}), Error);
  EXPECT_THROW(smooth_modes(egg(), {.deviation = 1.0, .length = 0.0}), Error);
}

}  // namespace
}  // namespace coxa::segment
