#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "thigh_observations.h"

// The method `coxa`: a ball joint whose markers share an artefact. See docs/motion.md section 4.
namespace coxa::motion {
namespace {

// covariance of the markers' artefacts along one axis: diag(variance) + shared 1 1^T
struct SharedArtefact {
  VecX variance;        // K, mm²
  double shared = 0.0;  // mm², of the shift that all markers have in common
  MatX covariance() const {
    const Eigen::Index K = variance.size();
    return MatX(variance.asDiagonal()) + MatX::Constant(K, K, shared);
  }
};

// mean over complete frames and the three axes of r r^T, K×K, mm²; empty when fewer than 10 frames
// are complete
MatX residual_moments(const ThighObservations& thigh, const PoseEstimate& estimate) {
  const Index K = thigh.n_markers();
  MatX sum = MatX::Zero(K, K);
  Index n = 0;
  for (Index frame = 0; frame < thigh.n_frames(); ++frame) {
    if (thigh.seen.row(frame).minCoeff() == 0) continue;
    const auto f = static_cast<std::size_t>(frame);
    const Points r = residuals_of(thigh, frame, estimate.R_PF[f], estimate.head[f]);
    sum += r * r.transpose();
    ++n;
  }
  return n < 10 ? MatX() : MatX(sum / (3.0 * n));
}

// expected squares given the moments: of the shared shift, and of what remains of each marker
struct Expected {
  double shift = 0.0;
  VecX own;
};
Expected expectation(const MatX& moments, const SharedArtefact& artefact) {
  if (artefact.shared <= 0) return {0.0, moments.diagonal()};
  const double uncertainty = 1.0 / (1.0 / artefact.shared + artefact.variance.cwiseInverse().sum());
  const VecX gain = uncertainty * artefact.variance.cwiseInverse();
  const double shift = gain.dot(moments * gain) + uncertainty;
  return {shift, moments.diagonal() - 2.0 * moments * gain + VecX::Constant(gain.size(), shift)};
}

double geometric_mean(const VecX& values) { return std::exp(values.array().log().mean()); }

// independent artefact patterns in the trial: participation ratio of the residuals' principal
// components
double pattern_count(const ThighObservations& thigh, const PoseEstimate& estimate) {
  const Index K = thigh.n_markers();
  MatX sum = MatX::Zero(3 * K, 3 * K);
  VecX mean = VecX::Zero(3 * K);
  double n = 0.0;
  for (Index frame = 0; frame < thigh.n_frames(); ++frame) {
    if (thigh.seen.row(frame).minCoeff() == 0) continue;
    const auto f = static_cast<std::size_t>(frame);
    const Points r = residuals_of(thigh, frame, estimate.R_PF[f], estimate.head[f]);
    const VecX row = r.reshaped();
    sum.selfadjointView<Eigen::Lower>().rankUpdate(row);
    mean += row;
    n += 1.0;
  }
  mean /= n;
  const MatX covariance = MatX(sum.selfadjointView<Eigen::Lower>()) / n - mean * mean.transpose();
  const double trace = covariance.trace();
  return covariance.squaredNorm() > 0 ? trace * trace / covariance.squaredNorm() : 1.0;
}

// marker variances drawn towards their common mean, and a shared shift in fixed proportion to it
PoseEstimate estimate_shared(const ThighObservations& thigh, double floor) {
  // A trial holds a handful of independent artefact patterns, so that a variance estimated from it
  // is worth few degrees of freedom: keep 0.3 of its logarithm's distance from the mean. The shared
  // part of thigh artefact exceeds that of single markers: three times the variance.
  constexpr double kOwnShare = 0.3, kSharedRatio = 3.0, kTolerance = 1e-5;
  constexpr int kMaxIterations = 100;
  const Index K = thigh.n_markers();
  SharedArtefact artefact{VecX::Constant(K, 50.0), kSharedRatio * 50.0};
  PoseEstimate estimate = estimate_ball_joint(thigh, artefact.covariance());
  estimate.converged = false;
  while (!estimate.converged && estimate.iterations < kMaxIterations) {
    const VecX own = expectation(residual_moments(thigh, estimate), artefact).own.cwiseMax(floor);
    const double mean = geometric_mean(own);
    const VecX next = (own.array() / mean).pow(kOwnShare) * mean;
    const double change =
        ((next - artefact.variance).array() / artefact.variance.array()).abs().maxCoeff();
    artefact = {next, kSharedRatio * mean};
    const int iterations = estimate.iterations + 1;
    estimate = estimate_ball_joint(thigh, artefact.covariance());
    estimate.iterations = iterations;
    estimate.converged = change < kTolerance;
  }
  return estimate;
}

}  // namespace

// equal marker variances and a shared shift, by maximum likelihood
SharedShift estimate_shared_shift(const ThighObservations& thigh, double floor_sd) {
  constexpr int kRounds = 30, kInner = 10;
  const Index K = thigh.n_markers();
  const double floor = floor_sd * floor_sd;
  SharedArtefact artefact{VecX::Constant(K, 50.0), 25.0};
  for (int round = 0; round < kRounds; ++round) {
    const MatX moments = residual_moments(thigh, estimate_ball_joint(thigh, artefact.covariance()));
    if (moments.size() == 0) return {0.0, floor};
    for (int inner = 0; inner < kInner; ++inner) {
      const Expected expected = expectation(moments, artefact);
      artefact.variance.setConstant(std::max(expected.own.mean(), floor));
      artefact.shared = std::max(expected.shift, 1e-3 * floor);
    }
  }
  return {artefact.shared, artefact.variance[0]};
}

PoseEstimate estimate_coxa(const ThighObservations& thigh, double floor_sd) {
  // Limits of the choice: below this shared share the pin at the joint centre is not dragged by a
  // common shift, and above this count a trial varies enough to tell steady markers from unsteady
  // ones.
  constexpr double kSmallShare = 0.2, kEnoughPatterns = 1.5;
  const double floor = floor_sd * floor_sd;
  PoseEstimate by_markers = estimate_ball_joint_ml(thigh, floor_sd);
  if (residual_moments(thigh, by_markers).size() == 0) {
    by_markers.note =
        "fewer than 10 frames show all thigh markers: marker variances estimated without a shared "
        "artefact";
    return by_markers;
  }
  const SharedShift shift = estimate_shared_shift(thigh, floor_sd);
  const bool separate =
      pattern_count(thigh, by_markers) > kEnoughPatterns && shift.shared < kSmallShare * shift.own;
  return separate ? by_markers : estimate_shared(thigh, floor);
}

}  // namespace coxa::motion
