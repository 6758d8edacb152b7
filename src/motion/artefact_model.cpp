#include "artefact_model.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

// Soft tissue artefact of a trial by restricted maximum likelihood: docs/motion.md section 4.
namespace coxa::motion {
namespace {

// Markers over moving tissue share their movement: the part they have in common has half the
// variance of what each has of its own; between 0.3 and 1 results hardly change.
constexpr double kShared = 0.5;
// Of what tells markers, and axes, apart a movement about one axis is believed a quarter; the rest
// falls with the square of the number of axes.
constexpr double kDisbelieved = 0.75;
constexpr double kSmallestVariance = 1e-6;  // mm²

// frames that show the same markers
struct FrameGroup {
  std::vector<Index> markers, frames;
};

std::vector<FrameGroup> frame_groups(const ThighObservations& thigh) {
  constexpr Index kFrames = 600;
  constexpr std::size_t kGroups = 40, kFewestMarkers = 3;
  const Index stride = std::max<Index>(1, thigh.n_frames() / kFrames);
  std::map<std::vector<Index>, std::vector<Index>> by_markers;
  for (Index frame = 0; frame < thigh.n_frames(); frame += stride) {
    const std::vector<Index> markers = seen_markers(thigh, frame);
    if (markers.size() >= kFewestMarkers) by_markers[markers].push_back(frame);
  }
  std::vector<FrameGroup> groups;
  for (auto& [markers, frames] : by_markers) groups.push_back({markers, std::move(frames)});
  std::stable_sort(groups.begin(), groups.end(), [](const FrameGroup& a, const FrameGroup& b) {
    return a.frames.size() > b.frames.size();
  });
  if (groups.size() > kGroups) groups.resize(kGroups);
  return groups;
}

// 3k×3k with the three axes' matrices on its diagonal
MatX block_diagonal(const AxisCovariance& blocks) {
  const Eigen::Index k = blocks[0].rows();
  MatX all = MatX::Zero(3 * k, 3 * k);
  for (int axis = 0; axis < 3; ++axis)
    all.block(axis * k, axis * k, k, k) = blocks[static_cast<std::size_t>(axis)];
  return all;
}

// how much of each marker's and axis' variance the residuals show, and how much they should
struct Shares {
  MatX shown, expected;  // K×3
};

// Derivatives of the restricted likelihood by the logarithms of the scales, of one group. Rotations
// are updated on the way.
void update_shares(const ThighObservations& thigh, const FrameGroup& group,
                   const AxisCovariance& artefact, const KnownErrors& known, std::vector<Mat3>& R,
                   Shares& shares) {
  const AxisCovariance part = part_of(artefact, group.markers);
  const Points x = thigh.x(group.markers, Eigen::all);
  const WeightedRotation rotation(x, with_known_errors(part, known));
  const auto n = static_cast<Index>(group.frames.size());
  MatX residuals(n, 3 * x.rows());
  parallel_for(n, [&](Index k) {
    const auto f = static_cast<std::size_t>(group.frames[static_cast<std::size_t>(k)]);
    const Points y = thigh.y[f](group.markers, Eigen::all);
    R[f] = rotation.solve(y, R[f]);
    const Points r = Points(y * R[f]) - x;
    residuals.row(k) = r.reshaped<Eigen::ColMajor>().transpose();
  });
  MatX J(3 * x.rows(), 3);
  for (int axis = 0; axis < 3; ++axis)
    J.middleRows(axis * x.rows(), x.rows()) = rotation_derivative(x, axis);
  const MatX W = block_diagonal(rotation.weights()), WJ = W * J;
  const MatX Q = W - WJ * rotation.inverse_information() * WJ.transpose();
  const MatX QMQ = Q * (residuals.transpose() * residuals) * Q, S = block_diagonal(part);
  const VecX shown = S.cwiseProduct(QMQ).rowwise().sum();
  const VecX expected = static_cast<double>(n) * S.cwiseProduct(Q).rowwise().sum();
  for (Eigen::Index m = 0; m < x.rows(); ++m) {
    const Index marker = group.markers[static_cast<std::size_t>(m)];
    for (int axis = 0; axis < 3; ++axis) {
      shares.shown(marker, axis) += shown[axis * x.rows() + m];
      shares.expected(marker, axis) += expected[axis * x.rows() + m];
    }
  }
}

// variances nearer to their common mean: `kept` of the distance of their logarithms is left
VecX drawn_together(const VecX& variance, double kept) {
  const double mean = std::exp(variance.array().log().mean());
  return mean * (variance.array() / mean).pow(kept);
}

// About how many axes the thigh turns: participation ratio of its rotations about their mean, 1 to
// 3. A movement about one axis shows each marker's artefact once, however many frames it has.
double axes_of_movement(const std::vector<Mat3>& R, const std::vector<bool>& valid) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t f = 0; f < R.size(); ++f) {
    if (valid[f]) sum += R[f];
  }
  const Mat3 middle = nearest_rotation(sum);
  Mat3 spread = Mat3::Zero();
  for (std::size_t f = 0; f < R.size(); ++f) {
    if (!valid[f]) continue;
    const Vec3 w = rotation_vector(middle.transpose() * R[f]);
    spread += w * w.transpose();
  }
  const double squares = spread.squaredNorm();
  return squares > 0 ? spread.trace() * spread.trace() / squares : 1.0;
}

// variances times what they fall short by, at most halved or doubled
VecX rescaled(const VecX& variance, const VecX& shown, const VecX& expected) {
  VecX next = variance;
  for (Eigen::Index k = 0; k < next.size(); ++k) {
    if (expected[k] > 0) next[k] *= std::clamp(shown[k] / expected[k], 0.5, 2.0);
  }
  return next.cwiseMax(kSmallestVariance);
}

}  // namespace

AxisCovariance ArtefactModel::covariance() const {
  const VecX sd = marker.cwiseSqrt();
  const MatX base = MatX(marker.asDiagonal()) + kShared * sd * sd.transpose();
  return {axis[0] * base, axis[1] * base, axis[2] * base};
}

AxisCovariance with_known_errors(const AxisCovariance& artefact, const KnownErrors& known) {
  const Eigen::Index K = artefact[0].rows();
  const MatX errors = known.marker * known.marker * MatX::Identity(K, K) +
                      MatX::Constant(K, K, known.shift * known.shift);
  return {artefact[0] + errors, artefact[1] + errors, artefact[2] + errors};
}

AxisCovariance part_of(const AxisCovariance& covariance, const std::vector<Index>& markers) {
  return {covariance[0](markers, markers), covariance[1](markers, markers),
          covariance[2](markers, markers)};
}

ArtefactModel estimate_artefact(const ThighObservations& thigh, const KnownErrors& known) {
  constexpr int kMaxIterations = 200;
  constexpr double kTolerance = 1e-4;      // relative change of a variance
  constexpr double kFirstVariance = 35.0;  // mm²
  const Index K = thigh.n_markers();
  const std::vector<FrameGroup> groups = frame_groups(thigh);
  const PoseEstimate rigid = estimate_rigid(thigh);
  std::vector<Mat3> R = rigid.R_PF;
  const double axes = axes_of_movement(R, rigid.valid);
  const double kept = 1.0 - kDisbelieved / (axes * axes);
  ArtefactModel model{.marker = VecX::Constant(K, kFirstVariance)};
  while (!model.converged && model.iterations < kMaxIterations) {
    const AxisCovariance artefact = model.covariance();
    Shares shares{MatX::Zero(K, 3), MatX::Zero(K, 3)};
    for (const FrameGroup& group : groups) update_shares(thigh, group, artefact, known, R, shares);
    const VecX marker = drawn_together(
        rescaled(model.marker, shares.shown.rowwise().sum(), shares.expected.rowwise().sum()),
        kept);
    VecX axis = rescaled(model.axis, shares.shown.colwise().sum().transpose(),
                         shares.expected.colwise().sum().transpose());
    axis = drawn_together(axis / std::exp(axis.array().log().mean()), kept);
    const double change = std::max((marker.array() / model.marker.array() - 1.0).abs().maxCoeff(),
                                   (axis.array() / model.axis.array() - 1.0).abs().maxCoeff());
    model.marker = marker;
    model.axis = axis;
    ++model.iterations;
    model.converged = change < kTolerance;
  }
  return model;
}

}  // namespace coxa::motion
