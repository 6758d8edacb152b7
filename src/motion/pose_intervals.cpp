#include "pose_intervals.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

// half-width of a 95 % interval in standard deviations
constexpr double kHalfWidth = 2.0;
// Of a rotation that all markers share: what it is about the long axis for movements about any
// axis, and about the other two axes, as a part of `common_rotation_share`.
constexpr double kLongAxisPart = 0.3, kOtherAxesPart = 0.2;

bool shift_is_free(PoseMethod method) {
  return method == PoseMethod::rigid || method == PoseMethod::paper ||
         method == PoseMethod::point_cluster;
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

// how errors of the markers become errors of the rotation; a free cluster translation removes the
// weighted mean
WeightedRotation fitted_rotation(const ThighObservations& thigh, const PoseEstimate& estimate,
                                 PoseMethod method) {
  const WeightedRotation pinned(thigh.x, estimate.covariance);
  if (!shift_is_free(method)) return pinned;
  AxisCovariance weights = pinned.weights();
  for (MatX& W : weights) {
    const VecX row_sums = W.rowwise().sum();
    W -= row_sums * row_sums.transpose() / row_sums.sum();
  }
  return WeightedRotation::from_weights(thigh.x, weights);
}

// turns away from the calibration pose in femur axes, and how much artefact each brings compared to
// the trial's mean: half of it grows with the square of the turn
struct Turns {
  std::vector<Vec3> away;
  VecX activity;
};

Turns turns_from(const std::vector<Mat3>& R, Index calibration_frame) {
  const auto n = static_cast<Index>(R.size());
  const Mat3 R_0 = R[static_cast<std::size_t>(calibration_frame)];
  Turns turns{{}, VecX(n)};
  for (Index frame = 0; frame < n; ++frame) {
    turns.away.push_back(rotation_vector(R_0.transpose() * R[static_cast<std::size_t>(frame)]));
    turns.activity[frame] = turns.away.back().squaredNorm();
  }
  const double mean = turns.activity.mean();
  if (mean > 0) {
    turns.activity = 0.5 + 0.5 * turns.activity.array() / mean;
  } else {
    turns.activity.setOnes();
  }
  return turns;
}

// rad², of a rotation that all thigh markers share, which no estimate from them can see
Mat3 common_rotation(const Vec3& away, double share) {
  const double all = std::pow(share, 2) * away.squaredNorm();
  Vec3 variance = Vec3::Constant(std::pow(kOtherAxesPart, 2) * all);
  variance.y() = std::pow(share * away.y(), 2) + std::pow(kLongAxisPart, 2) * all;
  return variance.asDiagonal();
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
                                      const PoseEstimate& estimate, const ArtefactModel& artefact,
                                      const std::optional<Mat3>& registration,
                                      const TrackOptions& options) {
  const ThighObservations& thigh = recording.thigh;
  const WeightedRotation fit = fitted_rotation(thigh, estimate, options.method);
  const Mat3 of_artefact = fit.propagated(artefact.covariance());
  const Mat3 of_shift = fit.shift_gain();
  const Index calibration_frame = model.calibration_frame.value_or(0);
  const Mat3 R_0 = estimate.R_PF[static_cast<std::size_t>(calibration_frame)];

  // what is the same in every frame
  double marker = std::pow(options.measurement_sd, 2);
  double shift =
      std::pow(options.joint_translation_sd, 2) + std::pow(recording.pelvis_centre_sd, 2);
  if (!registration) {
    marker += std::pow(model.marker_sd, 2);
    shift += std::pow(model.pelvis_centre_sd, 2) + std::pow(model.femur_centre_sd, 2);
  }
  const Index K = thigh.n_markers();
  const Mat3 constant = registration.value_or(Mat3::Zero()) +
                        fit.propagated(same_along_all_axes(marker * MatX::Identity(K, K))) +
                        shift * of_shift * of_shift.transpose();
  const Mat3 pelvis =
      std::pow(recording.pelvis_residual_sd, 2) * recording.pelvis_information.inverse();

  std::vector<bool> solved = recording.pelvis_seen;
  for (std::size_t f = 0; f < solved.size(); ++f) solved[f] = solved[f] && estimate.valid[f];
  const VecX bridged = bridge_deviation(estimate.R_PF, solved);
  const Turns turns = turns_from(estimate.R_PF, calibration_frame);
  std::vector<HipAngles> intervals(static_cast<std::size_t>(thigh.n_frames()));
  parallel_for(thigh.n_frames(), [&](Index frame) {
    const auto f = static_cast<std::size_t>(frame);
    const Mat3& R = estimate.R_PF[f];
    Mat3 covariance = constant + turns.activity[frame] * of_artefact;
    covariance += R.transpose() * pelvis * R + std::pow(bridged[frame], 2) * Mat3::Identity();
    covariance += common_rotation(turns.away[f], options.common_rotation_share);
    if (registration) {
      // the pelvis' joint centre was put right in the calibration pose and turns away with it
      const Mat3 turned = model.pelvis_centre_sd * of_shift * (R - R_0).transpose();
      covariance += turned * turned.transpose();
    }
    const Mat3 derivative = angle_derivative(R, model.side);
    const Vec3 width =
        kHalfWidth * (derivative * covariance * derivative.transpose()).diagonal().cwiseSqrt();
    intervals[f] = {.flexion = width[0], .adduction = width[1], .internal_rotation = width[2]};
  });
  return intervals;
}

}  // namespace coxa::motion
