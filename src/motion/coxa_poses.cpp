#include <coxa/core/parallel.h>

#include "artefact_model.h"

// The method `coxa`: a ball joint whose markers are weighed by the artefact that the trial shows.
// See docs/motion.md section 4.
namespace coxa::motion {

PoseEstimate estimate_coxa(const ThighObservations& thigh, const ArtefactModel& artefact,
                           const KnownErrors& known) {
  const Index K = thigh.n_markers();
  PoseEstimate estimate = estimate_ball_joint(thigh, MatX::Identity(K, K));
  estimate.covariance = with_known_errors(artefact.covariance(), known);
  estimate.iterations = artefact.iterations;
  estimate.converged = artefact.converged;
  const WeightedRotation of_all(thigh.x, estimate.covariance);
  parallel_for(thigh.n_frames(), [&](Index frame) {
    const auto f = static_cast<std::size_t>(frame);
    if (!estimate.valid[f]) return;
    const std::vector<Index> markers = seen_markers(thigh, frame);
    if (static_cast<Index>(markers.size()) == K) {
      estimate.R_PF[f] = of_all.solve(thigh.y[f], estimate.R_PF[f]);
      return;
    }
    const WeightedRotation rotation(thigh.x(markers, Eigen::all),
                                    part_of(estimate.covariance, markers));
    estimate.R_PF[f] = rotation.solve(thigh.y[f](markers, Eigen::all), estimate.R_PF[f]);
  });
  return estimate;
}

std::optional<Registered> registered_positions(const ThighObservations& thigh, Index frame,
                                               const KnownErrors& known) {
  constexpr std::size_t kFewestMarkers = 3;
  const std::vector<Index> markers = seen_markers(thigh, frame);
  if (markers.size() < kFewestMarkers) return std::nullopt;
  const auto k = static_cast<Eigen::Index>(markers.size());
  const Points x = thigh.x(markers, Eigen::all);
  const Points y = thigh.y[static_cast<std::size_t>(frame)](markers, Eigen::all);
  const WeightedRotation rotation(x,
                                  with_known_errors(same_along_all_axes(MatX::Zero(k, k)), known));
  const Mat3 R = rotation.solve(y, nearest_rotation(y.transpose() * x));
  Registered registered{thigh.x, rotation.inverse_information()};
  registered.x(markers, Eigen::all) = y * R;
  return registered;
}

}  // namespace coxa::motion
