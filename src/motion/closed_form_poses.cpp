#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "thigh_observations.h"

namespace coxa::motion {
namespace {

PoseEstimate empty_estimate(const ThighObservations& thigh) {
  const auto n = static_cast<std::size_t>(thigh.n_frames());
  PoseEstimate estimate;
  estimate.R_PF.assign(n, Mat3::Identity());
  estimate.head.assign(n, Vec3::Zero());
  estimate.valid.assign(n, false);
  estimate.covariance = same_along_all_axes(MatX::Identity(thigh.n_markers(), thigh.n_markers()));
  return estimate;
}

// vector<bool> packs bits, so frames may not write it side by side
void update_validity(PoseEstimate& estimate, const std::vector<char>& valid) {
  for (std::size_t k = 0; k < valid.size(); ++k) estimate.valid[k] = valid[k] != 0;
}

// the frame of each row's own markers; false when too few are seen
template <class Solve>
PoseEstimate per_frame(const ThighObservations& thigh, std::size_t needed, const Solve& solve) {
  PoseEstimate estimate = empty_estimate(thigh);
  std::vector<char> valid(estimate.valid.size(), 0);
  parallel_for(thigh.n_frames(), [&](Index frame) {
    const std::vector<Index> markers = seen_markers(thigh, frame);
    if (markers.size() < needed) return;
    const auto f = static_cast<std::size_t>(frame);
    const Points x = thigh.x(markers, Eigen::all), y = thigh.y[f](markers, Eigen::all);
    solve(markers, x, y, estimate.R_PF[f], estimate.head[f]);
    valid[f] = 1;
  });
  update_validity(estimate, valid);
  return estimate;
}

}  // namespace

std::vector<Index> seen_markers(const ThighObservations& thigh, Index frame) {
  std::vector<Index> markers;
  for (Index m = 0; m < thigh.n_markers(); ++m) {
    if (thigh.seen(frame, m) > 0) markers.push_back(m);
  }
  return markers;
}

Mat3 nearest_rotation(const Mat3& M) {
  const Eigen::JacobiSVD<Mat3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  return svd.matrixU() * Vec3(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

Points residuals_of(const ThighObservations& thigh, Index frame, const Mat3& R_PF,
                    const Vec3& head) {
  const Points& y = thigh.y[static_cast<std::size_t>(frame)];
  return Points((y.rowwise() - head.transpose()) * R_PF) - thigh.x;
}

PoseEstimate estimate_rigid(const ThighObservations& thigh) {
  return per_frame(thigh, 3,
                   [](const auto&, const Points& x, const Points& y, Mat3& R, Vec3& head) {
                     const Vec3 mean_x = x.colwise().mean(), mean_y = y.colwise().mean();
                     R = nearest_rotation((y.rowwise() - mean_y.transpose()).transpose() *
                                          (x.rowwise() - mean_x.transpose()));
                     head = mean_y - R * mean_x;
                   });
}

PoseEstimate estimate_paper(const ThighObservations& thigh) {
  PoseEstimate estimate = estimate_rigid(thigh);
  std::fill(estimate.head.begin(), estimate.head.end(), Vec3::Zero());
  return estimate;
}

PoseEstimate estimate_ball_joint(const ThighObservations& thigh, const MatX& covariance) {
  const Index K = thigh.n_markers();
  const MatX all_weights = covariance.llt().solve(MatX::Identity(K, K));
  PoseEstimate estimate = per_frame(
      thigh, 2,
      [&](const std::vector<Index>& markers, const Points& x, const Points& y, Mat3& R, Vec3&) {
        const auto n = static_cast<Eigen::Index>(markers.size());
        if (n == K) {
          R = nearest_rotation(y.transpose() * all_weights * x);
        } else {
          const MatX part = covariance(markers, markers);
          R = nearest_rotation(y.transpose() * part.llt().solve(MatX(x)));
        }
      });
  estimate.covariance = same_along_all_axes(covariance);
  return estimate;
}

PoseEstimate estimate_ball_joint_ml(const ThighObservations& thigh, double floor_sd) {
  constexpr int kMaxIterations = 200;
  constexpr double kTolerance = 1e-6;  // relative change of the variances
  const Index K = thigh.n_markers();
  PoseEstimate estimate = estimate_ball_joint(thigh, MatX::Identity(K, K));
  estimate.converged = false;
  VecX variance = VecX::Constant(K, 1.0);
  while (!estimate.converged && estimate.iterations < kMaxIterations) {
    VecX sum = VecX::Zero(K), count = VecX::Zero(K);
    for (Index frame = 0; frame < thigh.n_frames(); ++frame) {
      const auto f = static_cast<std::size_t>(frame);
      if (!estimate.valid[f]) continue;
      const Points r = residuals_of(thigh, frame, estimate.R_PF[f], estimate.head[f]);
      for (Index m = 0; m < K; ++m) {
        if (thigh.seen(frame, m) == 0) continue;
        sum[m] += r.row(m).squaredNorm();
        count[m] += 3.0;
      }
    }
    const VecX next = (sum.array() / count.array().max(1.0)).max(floor_sd * floor_sd);
    const double change = ((next - variance).array() / variance.array()).abs().maxCoeff();
    variance = next;
    const int iterations = estimate.iterations + 1;
    estimate = estimate_ball_joint(thigh, variance.asDiagonal());
    estimate.iterations = iterations;
    estimate.converged = change < kTolerance;
  }
  return estimate;
}

}  // namespace coxa::motion
