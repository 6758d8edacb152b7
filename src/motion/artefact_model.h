#pragma once

#include "weighted_rotation.h"

namespace coxa::motion {

/// Errors of a marker that are no soft tissue artefact, mm, standard deviations per axis.
struct KnownErrors {
  double marker = 0.0;  ///< > 0, of each marker by itself: cameras, registration
  double shift = 0.0;   ///< >= 0, that all markers share: joint centre, joint translation
};

/// How soft tissue artefact is spread over markers and axes: covariance along axis k
/// axis_k D (1 + shared · 1 1^T) D with D = diag(sqrt(marker)).
struct ArtefactModel {
  VecX marker;  ///< K, mm², each marker's own variance
  Vec3 axis =
      Vec3::Ones();  ///< relative variance along the femur's axes, their geometric mean is 1
  int iterations = 0;
  bool converged = false;

  AxisCovariance covariance() const;  ///< of artefact alone
};

/// Adds the known errors to a covariance of artefact.
AxisCovariance with_known_errors(const AxisCovariance& artefact, const KnownErrors& known);
/// Rows and columns of some markers.
AxisCovariance part_of(const AxisCovariance& covariance, const std::vector<Index>& markers);

/// The artefact that makes the trial's residuals most likely, the rotations of its frames being
/// unknown (restricted maximum likelihood), drawn towards equal markers and equal axes.
///
/// Uses at most some 600 frames, evenly spread, of the 40 commonest sets of visible markers.
/// @note bit-identical for any number of threads
/// Source: docs/motion.md section 4.
ArtefactModel estimate_artefact(const ThighObservations& thigh, const KnownErrors& known);

/// Rotation about the joint centre with the covariance of artefact and known errors.
PoseEstimate estimate_coxa(const ThighObservations& thigh, const ArtefactModel& artefact,
                           const KnownErrors& known);

/// The thigh marker positions as one frame shows them.
struct Registered {
  Points x;                        ///< K×3, mm, of markers not seen in that frame as they were
  Mat3 covariance = Mat3::Zero();  ///< rad², of the rotation error common to all positions
};
/// Marker positions known with an error, put right by the frame in which they were measured.
///
/// In that frame the artefact is nothing by definition, so that what does not fit is registration
/// error: after one fit of the rotation only its three angles stay unknown.
/// @param known  errors of the registration
/// @returns nullopt where the frame shows fewer than three markers
std::optional<Registered> registered_positions(const ThighObservations& thigh, Index frame,
                                               const KnownErrors& known);

}  // namespace coxa::motion
