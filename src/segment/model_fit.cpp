#include <coxa/segment/model_fit.h>

#include <coxa/segment/body.h>

#include <Eigen/Cholesky>

#include <algorithm>

namespace coxa::segment {
namespace {

constexpr int kAlternations = 4;
/// The errors of neighbouring vertices are alike: a whole surface counts as this many independent
/// ones.
constexpr double kIndependentVertices = 300.0;
constexpr double kLargestCoefficient = 3.0;

/// Adult hips differ in size by 7 % (one standard deviation); what is farther off is no hip, or not
/// found yet.
constexpr double kLargestScale = 1.25;

/// The pose with its scale kept to what adults have.
Similarity of_adult_size(const Similarity& pose, const Points& shape, const Points& targets,
                         const VecX& weights) {
  const double scale = std::clamp(pose.scale, 1.0 / kLargestScale, kLargestScale);
  if (scale == pose.scale) return pose;
  return {scale, fit_rigid(scale * shape, targets, weights)};
}

}  // namespace

ModelFit fit_model(const shape::StructureModel& model, const Points& targets, const VecX& weights,
                   double noise) {
  const Points& mean = model.hierarchy.levels.back().points;
  const auto V = static_cast<Index>(mean.rows());
  const auto k = static_cast<Index>(model.shape.deviations.size());
  const VecX safe = weights.array() + 1e-9;
  ModelFit fit;
  fit.coefficients = VecX::Zero(k);
  Points shape = mean;
  // modes scaled to standard deviations, and the normal matrix of the weighted fit
  const MatX scaled = model.shape.modes * model.shape.deviations.asDiagonal();
  VecX row_weights(3 * Eigen::Index{V});
  for (Index v = 0; v < V; ++v) row_weights.segment<3>(3 * v).setConstant(weights[v]);
  const double trust = kIndependentVertices / (V * noise * noise);
  const MatX weighted = row_weights.asDiagonal() * scaled;
  const MatX normal = trust * (scaled.transpose() * weighted) + MatX::Identity(k, k);
  const Eigen::LLT<MatX> solver(normal);
  for (int round = 0; round < kAlternations; ++round) {
    fit.pose = fit_similarity(shape, targets, safe);
    fit.pose = of_adult_size(fit.pose, shape, targets, safe);
    if (k == 0) break;
    const RigidTransform back = fit.pose.X.inverse();
    const Points local = transformed(targets, back) / fit.pose.scale;
    const Points off = local - mean;
    const VecX residual = Eigen::Map<const VecX>(off.data(), off.size());
    fit.coefficients = solver.solve(trust * (weighted.transpose() * residual));
    fit.coefficients =
        fit.coefficients.cwiseMax(-kLargestCoefficient).cwiseMin(kLargestCoefficient);
    const VecX change = scaled * fit.coefficients;
    shape = mean + Eigen::Map<const Points>(change.data(), V, 3);
  }
  fit.points = posed(shape, fit.pose);
  return fit;
}

}  // namespace coxa::segment
