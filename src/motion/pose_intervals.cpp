#include "pose_intervals.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

// half-width of a 95 % interval in standard deviations: Student's t for 7 degrees of freedom,
// because a trial holds two or three independent artefact patterns of three axes each, however many
// frames it has
constexpr double kHalfWidth = 2.36;

bool shift_is_free(PoseMethod method) {
  return method == PoseMethod::rigid || method == PoseMethod::paper ||
         method == PoseMethod::point_cluster;
}

Mat3 cross_matrix(const Vec3& v) {
  Mat3 S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

// derivative of (flexion, adduction, internal rotation) by a small rotation of the femur about its
// own axes
Mat3 angle_derivative(const Mat3& R_PF, Side side) {
  constexpr double kStep = 1e-6;
  Mat3 derivative;
  for (int k = 0; k < 3; ++k) {
    const Vec3 step = kStep * Vec3::Unit(k);
    const HipAngles plus = angles_from_rotation(R_PF * rotation_from_vector(step), side);
    const HipAngles minus = angles_from_rotation(R_PF * rotation_from_vector(-step), side);
    derivative.col(k) = Vec3(plus.flexion - minus.flexion, plus.adduction - minus.adduction,
                             plus.internal_rotation - minus.internal_rotation) /
                        (2.0 * kStep);
  }
  return derivative;
}

// how errors of the marker positions become a rotation error (femur axes): delta = sum_m gain_m e_m
struct Gains {
  std::vector<Mat3> of_marker;
  Mat3 of_shift = Mat3::Zero();  // of a shift common to all markers
};

Gains rotation_gains(const Points& x, const MatX& weights) {
  const Eigen::Index K = x.rows();
  const Points centre_weighted = weights * x;
  Mat3 information = Mat3::Zero();
  for (Eigen::Index m = 0; m < K; ++m) {
    for (Eigen::Index l = 0; l < K; ++l) {
      information += weights(m, l) * cross_matrix(x.row(m)).transpose() * cross_matrix(x.row(l));
    }
  }
  const Mat3 inverse = information.inverse();
  Gains gains;
  for (Eigen::Index m = 0; m < K; ++m) {
    gains.of_marker.push_back(inverse * cross_matrix(centre_weighted.row(m)));
    gains.of_shift += gains.of_marker.back();
  }
  return gains;
}

// weights of the fit: per-axis precision; free cluster translation removes the weighted mean
MatX fit_weights(const MatX& covariance, PoseMethod method) {
  const Eigen::Index K = covariance.rows();
  const MatX W = covariance.llt().solve(MatX::Identity(K, K));
  if (!shift_is_free(method)) return W;
  const VecX row_sums = W.rowwise().sum();
  return W - row_sums * row_sums.transpose() / row_sums.sum();
}

// rad, how far a bridged frame may be off: half of the turn across its gap, in its middle; at the
// ends of the recording the turn over as many frames beside the gap; 0 in frames that were solved
VecX bridge_deviation(const std::vector<Mat3>& R, const std::vector<bool>& solved) {
  const auto n = static_cast<Index>(R.size());
  VecX deviation = VecX::Zero(n);
  const auto turn = [&](Index a, Index b) {
    const auto clamped = [&](Index k) {
      return static_cast<std::size_t>(std::clamp<Index>(k, 0, n - 1));
    };
    return rotation_vector(R[clamped(a)].transpose() * R[clamped(b)]).norm();
  };
  for (Index begin = 0; begin < n; ++begin) {
    if (solved[static_cast<std::size_t>(begin)]) continue;
    Index end = begin;
    while (end < n && !solved[static_cast<std::size_t>(end)]) ++end;
    for (Index k = begin; k < end; ++k) {
      const double share = static_cast<double>(k + 1 - begin) / (end + 1 - begin);
      if (begin == 0) {
        deviation[k] = turn(end, 2 * end - k);
      } else if (end == n) {
        deviation[k] = turn(begin - 1, 2 * (begin - 1) - k);
      } else {
        deviation[k] = 2.0 * share * (1.0 - share) * turn(begin - 1, end);
      }
    }
    begin = end;
  }
  return deviation;
}

}  // namespace

std::vector<HipAngles> pose_intervals(const HipRecording& recording, const HipModel& model,
                                      const PoseEstimate& estimate, const TrackOptions& options) {
  const ThighObservations& thigh = recording.thigh;
  const Index K = thigh.n_markers();
  const Gains gains = rotation_gains(thigh.x, fit_weights(estimate.covariance, options.method));

  // variance of each marker's residuals over the trial
  VecX variance = VecX::Zero(K), count = VecX::Zero(K);
  for (Index frame = 0; frame < thigh.n_frames(); ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    const Points r = residuals_of(thigh, frame, estimate.R_PF[f], estimate.head[f]);
    for (Index m = 0; m < K; ++m) {
      if (thigh.seen(frame, m) == 0) continue;
      variance[m] += r.row(m).squaredNorm() / 3.0;
      count[m] += 1.0;
    }
  }
  const double floor = options.measurement_sd * options.measurement_sd;
  variance = (variance.array() / count.array().max(1.0)).max(floor);
  Mat3 artefact = Mat3::Zero(), registration = Mat3::Zero();
  for (Index m = 0; m < K; ++m) {
    const Mat3 square = gains.of_marker[static_cast<std::size_t>(m)] *
                        gains.of_marker[static_cast<std::size_t>(m)].transpose();
    artefact += variance[m] * square;
    registration += model.marker_sd * model.marker_sd * square;
  }
  const double centre = std::pow(model.pelvis_centre_sd, 2) + std::pow(model.femur_centre_sd, 2) +
                        std::pow(options.joint_translation_sd, 2);
  // a shift that all markers share turns a pinned thigh
  const double shared = shift_is_free(options.method)
                            ? 0.0
                            : estimate_shared_shift(thigh, options.measurement_sd).shared;
  artefact += shared * gains.of_shift * gains.of_shift.transpose();
  registration += centre * gains.of_shift * gains.of_shift.transpose();
  const Mat3 pelvis =
      std::pow(recording.pelvis_residual_sd, 2) * recording.pelvis_information.inverse();

  const Mat3 R_calibration =
      estimate.R_PF[static_cast<std::size_t>(model.calibration_frame.value_or(0))];
  std::vector<bool> solved = recording.pelvis_seen;
  for (std::size_t f = 0; f < solved.size(); ++f) solved[f] = solved[f] && estimate.valid[f];
  const VecX bridged = bridge_deviation(estimate.R_PF, solved);
  std::vector<HipAngles> intervals(static_cast<std::size_t>(thigh.n_frames()));
  parallel_for(thigh.n_frames(), [&](Index frame) {
    const auto f = static_cast<std::size_t>(frame);
    const Mat3& R = estimate.R_PF[f];
    const Vec3 away = rotation_vector(R_calibration.transpose() * R);
    Mat3 covariance = artefact + registration + R.transpose() * pelvis * R;
    covariance += std::pow(bridged[frame], 2) * Mat3::Identity();
    covariance(1, 1) += std::pow(options.common_rotation_share * away.y(), 2);
    const Mat3 derivative = angle_derivative(R, model.side);
    const Vec3 width =
        kHalfWidth * (derivative * covariance * derivative.transpose()).diagonal().cwiseSqrt();
    intervals[f] = {.flexion = width[0], .adduction = width[1], .internal_rotation = width[2]};
  });
  return intervals;
}

}  // namespace coxa::motion
