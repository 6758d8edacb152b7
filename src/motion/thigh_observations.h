#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/rigid_transform.h>

#include <array>
#include <optional>
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

/// Covariance of the markers' errors along each femur axis, K×K, mm²; the axes are independent.
using AxisCovariance = std::array<MatX, 3>;
/// The same K×K matrix along all three axes.
AxisCovariance same_along_all_axes(const MatX& covariance);

/// What a pose method finds; frames it could not solve have `valid` false and are filled by the
/// caller.
struct PoseEstimate {
  std::vector<Mat3> R_PF;     ///< per frame
  std::vector<Vec3> head;     ///< per frame, mm: femoral head from the joint centre, pelvis axes
  std::vector<bool> valid;    ///< per frame
  AxisCovariance covariance;  ///< by whose inverse the method weighed the markers
  int iterations = 0;
  bool converged = true;
};

/// The rotation that maximises trace(R^T M): the nearest one to M.
Mat3 nearest_rotation(const Mat3& M);

/// Numbers of the markers seen in a frame, increasing.
std::vector<Index> seen_markers(const ThighObservations& thigh, Index frame);

PoseEstimate estimate_rigid(const ThighObservations& thigh);
/// Rotation of `estimate_rigid`, head kept at the joint centre (the paper's objective in closed
/// form).
PoseEstimate estimate_paper(const ThighObservations& thigh);
PoseEstimate estimate_point_cluster(const ThighObservations& thigh);
/// Rotation about the joint centre; `covariance` K×K weighs the markers (identity: equal weights).
PoseEstimate estimate_ball_joint(const ThighObservations& thigh, const MatX& covariance);
/// The covariance diag(v) that makes the observed residuals most likely, and the poses with it.
PoseEstimate estimate_ball_joint_ml(const ThighObservations& thigh, double floor_sd);

/// Residuals R^T y - x of frame f, K×3, mm; NaN rows where a marker was not seen.
Points residuals_of(const ThighObservations& thigh, Index frame, const Mat3& R_PF,
                    const Vec3& head);

}  // namespace coxa::motion
