#include <coxa/segment/model_fit.h>

#include <coxa/segment/body.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <vector>

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

/// Vertices that take part: enough for hundreds of unknowns, few enough to be quick.
constexpr Index kMostVertices = 4000;

/// The linear part of the fit: coefficients z of the model's modes and of the smooth ones (x, y and
/// z in turn) with prior N(0, 1), from residuals of every stride-th vertex.
class LinearFit {
 public:
  LinearFit(const MatX& scaled, const SmoothModes* smooth, const VecX& weights, double noise)
      : k_(static_cast<Index>(scaled.cols())),
        m_(smooth ? static_cast<Index>(smooth->moves.cols()) : 0) {
    const auto V = static_cast<Index>(weights.size());
    const Index stride = (V + kMostVertices - 1) / kMostVertices;
    for (Index v = 0; v < V; v += stride) rows_.push_back(v);
    const auto n = static_cast<Index>(rows_.size());
    const VecX weight =
        weights(rows_) * (kIndependentVertices / (static_cast<double>(n) * noise * noise));
    const Eigen::Index size = k_ + 3 * Eigen::Index{m_};
    MatX normal = MatX::Identity(size, size);
    if (m_ > 0) weighted_smooth_ = weight.asDiagonal() * smooth->moves(rows_, Eigen::all);
    const MatX among =
        m_ > 0 ? MatX(smooth->moves(rows_, Eigen::all).transpose() * weighted_smooth_) : MatX();
    for (Index axis = 0; axis < 3; ++axis) {
      MatX modes(n, k_);
      for (Index i = 0; i < n; ++i)
        modes.row(i) = scaled.row(3 * Eigen::Index{rows_[static_cast<std::size_t>(i)]} + axis);
      weighted_modes_[axis] = weight.asDiagonal() * modes;
      normal.topLeftCorner(k_, k_) += modes.transpose() * weighted_modes_[axis];
      if (m_ == 0) continue;
      const Index first = k_ + axis * m_;
      normal.block(first, first, m_, m_) += among;
      normal.block(first, 0, m_, k_) += weighted_smooth_.transpose() * modes;
      normal.block(0, first, k_, m_) = normal.block(first, 0, m_, k_).transpose();
    }
    solver_.compute(normal);
  }

  /// @param off V×3, mm from the mean
  VecX solve(const Points& off) const {
    VecX right = VecX::Zero(k_ + 3 * Eigen::Index{m_});
    for (Index axis = 0; axis < 3; ++axis) {
      const VecX column = off(rows_, axis);
      right.head(k_) += weighted_modes_[axis].transpose() * column;
      if (m_ > 0) right.segment(k_ + axis * m_, m_) = weighted_smooth_.transpose() * column;
    }
    return solver_.solve(right);
  }

 private:
  Index k_, m_;
  std::vector<Index> rows_;
  std::array<MatX, 3> weighted_modes_;
  MatX weighted_smooth_;
  Eigen::LLT<MatX> solver_;
};

}  // namespace

ModelFit fit_model(const shape::StructureModel& model, const Points& targets, const VecX& weights,
                   double noise, const SmoothModes* smooth) {
  const Points& mean = model.hierarchy.levels.back().points;
  const auto k = static_cast<Index>(model.shape.deviations.size());
  const VecX safe = weights.array() + 1e-9;
  ModelFit fit;
  fit.coefficients = VecX::Zero(k);
  Points shape = mean;
  // modes scaled to standard deviations
  const MatX scaled = model.shape.modes * model.shape.deviations.asDiagonal();
  const LinearFit linear(scaled, smooth, weights, noise);
  for (int round = 0; round < kAlternations; ++round) {
    fit.pose = fit_similarity(shape, targets, safe);
    fit.pose = of_adult_size(fit.pose, shape, targets, safe);
    const RigidTransform back = fit.pose.X.inverse();
    const Points local = transformed(targets, back) / fit.pose.scale;
    const VecX all = linear.solve(local - mean);
    fit.coefficients = all.head(k).cwiseMax(-kLargestCoefficient).cwiseMin(kLargestCoefficient);
    const VecX change = scaled * fit.coefficients;
    shape = mean + Eigen::Map<const Points>(change.data(), mean.rows(), 3);
    if (!smooth) continue;
    const Eigen::Index m = smooth->moves.cols();
    const Points beside = smooth->moves * Eigen::Map<const MatX>(all.data() + k, m, 3);
    fit.off_model = beside.rowwise().norm().mean();
    shape += beside;
  }
  fit.points = posed(shape, fit.pose);
  return fit;
}

}  // namespace coxa::segment
