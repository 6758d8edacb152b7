#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>

#include <string>
#include <vector>

namespace coxa::motion {

/// Thigh markers seen from the hip joint: what every pose method works on.
struct ThighObservations {
  Points x;  ///< K×3, mm, positions on the femur: femur axes, from the joint centre
  std::vector<Points>
      y;      ///< per frame K×3, mm, measured: pelvis axes, from the joint centre; NaN if unseen
  MatX seen;  ///< frames×K, 1 or 0

  Index n_frames() const { return static_cast<Index>(y.size()); }
  Index n_markers() const { return static_cast<Index>(x.rows()); }
};

/// What a pose method finds; frames it could not solve have `valid` false and are filled by the
/// caller.
struct PoseEstimate {
  std::vector<Mat3> R_PF;   ///< per frame
  std::vector<Vec3> head;   ///< per frame, mm: femoral head from the joint centre, pelvis axes
  std::vector<bool> valid;  ///< per frame
  MatX covariance;   ///< K×K, mm² per axis: artefact of the markers, common to the three axes
  std::string note;  ///< what the user should know about how it was found; may be empty
  int iterations = 0;
  bool converged = true;
};

/// The rotation that maximises trace(R^T M): the nearest one to M.
Mat3 nearest_rotation(const Mat3& M);

PoseEstimate estimate_rigid(const ThighObservations& thigh);
/// Rotation of `estimate_rigid`, head kept at the joint centre (the paper's objective in closed
/// form).
PoseEstimate estimate_paper(const ThighObservations& thigh);
PoseEstimate estimate_point_cluster(const ThighObservations& thigh);
/// Rotation about the joint centre; `covariance` K×K weighs the markers (identity: equal weights).
PoseEstimate estimate_ball_joint(const ThighObservations& thigh, const MatX& covariance);
/// The covariance diag(v) that makes the observed residuals most likely, and the poses with it.
PoseEstimate estimate_ball_joint_ml(const ThighObservations& thigh, double floor_sd);

/// Ball joint with marker variances and a shift that all markers share; which of two weightings,
/// the trial decides.
PoseEstimate estimate_coxa(const ThighObservations& thigh, double floor_sd);

/// Artefact that all markers share and that each has of its own, per axis, mm².
struct SharedShift {
  double shared = 0.0, own = 0.0;
};
/// By maximum likelihood over the trial, with equal variances; shared 0 where too few frames are
/// complete.
SharedShift estimate_shared_shift(const ThighObservations& thigh, double floor_sd);

/// Residuals R^T y - x of frame f, K×3, mm; NaN rows where a marker was not seen.
Points residuals_of(const ThighObservations& thigh, Index frame, const Mat3& R_PF,
                    const Vec3& head);

}  // namespace coxa::motion
