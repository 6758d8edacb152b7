#include "hip_recording.h"

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/cross_matrix.h>
#include <coxa/geom/fits.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

struct Matched {
  std::vector<std::string> labels;
  std::vector<Index> columns;  // in the recording
  Points positions;            // on the bone
};

Matched match(const MarkerData& markers, const std::map<std::string, Vec3>& model, const char* bone,
              std::vector<std::string>& warnings) {
  Matched matched;
  std::vector<Vec3> positions;
  std::string missing;
  for (const auto& [label, position] : model) {
    const auto column = find_marker(markers, label);
    if (!column) {
      missing += (missing.empty() ? "" : ", ") + label;
      continue;
    }
    matched.labels.push_back(label);
    matched.columns.push_back(*column);
    positions.push_back(position);
  }
  if (positions.size() < 3) {
    std::string there;
    for (const std::string& label : markers.labels) there += (there.empty() ? "" : ", ") + label;
    fail(ErrorCode::bad_input, "only ", positions.size(), " of the model's ", bone,
         " markers are in the recording (3 are needed); missing: ", missing,
         "; the recording has: ", there);
  }
  if (!missing.empty()) {
    warnings.push_back(std::string(bone) +
                       " markers of the model that the recording lacks: " + missing);
  }
  matched.positions.resize(static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    matched.positions.row(static_cast<Eigen::Index>(k)) = positions[k];
  }
  return matched;
}

// rows of the matched markers in one frame; unseen ones are NaN
Points positions_at(const MarkerData& markers, const Matched& matched, Index frame) {
  Points p(static_cast<Eigen::Index>(matched.columns.size()), 3);
  for (std::size_t k = 0; k < matched.columns.size(); ++k) {
    p.row(static_cast<Eigen::Index>(k)) =
        markers.trajectories[static_cast<std::size_t>(matched.columns[k])].row(frame);
  }
  return p;
}

std::vector<Index> finite_rows(const Points& p) {
  std::vector<Index> rows;
  for (Index k = 0; k < p.rows(); ++k) {
    if (p.row(k).allFinite()) rows.push_back(k);
  }
  return rows;
}

// root mean square per axis, for a unit spread of the n markers of a rigid fit, of what a point at
// `arm` from their mean moves by
double carried_spread(const Vec3& arm, const Mat3& information, Index n) {
  const Mat3 turn = cross_matrix(arm) * information.inverse() * cross_matrix(arm).transpose();
  return std::sqrt(1.0 / static_cast<double>(n) + turn.trace() / 3.0);
}

void fit_pelvis(const MarkerData& markers, const Matched& pelvis, const Vec3& joint_centre,
                HipRecording& recording, std::vector<std::string>& warnings) {
  const auto n = static_cast<std::size_t>(markers.n_frames());
  recording.X_LP.assign(n, RigidTransform{});
  std::vector<char> known(n, 0);
  VecX squares = VecX::Zero(markers.n_frames()), freedom = VecX::Zero(markers.n_frames());
  parallel_for(markers.n_frames(), [&](Index frame) {
    const Points p = positions_at(markers, pelvis, frame);
    const std::vector<Index> rows = finite_rows(p);
    if (rows.size() < 3) return;
    const Points a = pelvis.positions(rows, Eigen::all), b = p(rows, Eigen::all);
    const RigidTransform X = fit_rigid(a, b);
    recording.X_LP[static_cast<std::size_t>(frame)] = X;
    squares[frame] = (transformed(a, X) - b).squaredNorm();
    freedom[frame] = 3.0 * static_cast<double>(rows.size()) - 6.0;
    known[static_cast<std::size_t>(frame)] = 1;
  });
  recording.pelvis_seen.assign(known.begin(), known.end());
  require(std::find(known.begin(), known.end(), 1) != known.end(),
          "no frame shows three pelvis markers at once");
  if (std::find(known.begin(), known.end(), 0) != known.end()) {
    warnings.push_back("pelvis bridged in " + list_of_missing(recording.pelvis_seen));
  }
  update_missing_poses(recording.X_LP, recording.pelvis_seen);
  recording.pelvis_residual_sd = std::sqrt(squares.sum() / std::max(1.0, freedom.sum()));

  const Vec3 mean = pelvis.positions.colwise().mean();
  const Points d = pelvis.positions.rowwise() - mean.transpose();
  const Mat3 second = d.transpose() * d;
  recording.pelvis_information = second.trace() * Mat3::Identity() - second;
  recording.pelvis_centre_sd =
      recording.pelvis_residual_sd *
      carried_spread(joint_centre - mean, recording.pelvis_information, pelvis.positions.rows());
}

}  // namespace

HipRecording make_recording(const MarkerData& markers, const HipModel& model,
                            std::vector<std::string>& warnings) {
  check_model(model);
  require(markers.n_frames() > 0 && markers.rate > 0,
          "the recording has no frame or no frame rate");
  HipRecording recording;
  const Matched pelvis = match(markers, model.pelvis_markers, "pelvis", warnings);
  const Matched thigh = match(markers, model.thigh_markers, "thigh", warnings);
  fit_pelvis(markers, pelvis, model.joint_centre_pelvis, recording, warnings);

  const Index K = static_cast<Index>(thigh.columns.size());
  recording.thigh_labels = thigh.labels;
  recording.thigh.x = thigh.positions.rowwise() - model.joint_centre_femur.transpose();
  recording.thigh.y.resize(static_cast<std::size_t>(markers.n_frames()));
  recording.thigh.seen = MatX::Zero(markers.n_frames(), K);
  parallel_for(markers.n_frames(), [&](Index frame) {
    const auto f = static_cast<std::size_t>(frame);
    Points y = transformed(positions_at(markers, thigh, frame), recording.X_LP[f].inverse());
    y.rowwise() -= model.joint_centre_pelvis.transpose();
    for (Index m = 0; m < K; ++m) recording.thigh.seen(frame, m) = y.row(m).allFinite() ? 1.0 : 0.0;
    recording.thigh.y[f] = std::move(y);
  });
  return recording;
}

void update_missing_poses(std::vector<RigidTransform>& poses, const std::vector<bool>& known) {
  const std::size_t n = poses.size();
  for (std::size_t begin = 0; begin < n;) {
    if (known[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < n && !known[end]) ++end;
    COXA_ASSERT(begin > 0 || end < n);
    for (std::size_t k = begin; k < end; ++k) {
      if (begin == 0 || end == n) {
        poses[k] = begin == 0 ? poses[end] : poses[begin - 1];
        continue;
      }
      const RigidTransform &a = poses[begin - 1], &b = poses[end];
      const double share =
          static_cast<double>(k + 1 - begin) / static_cast<double>(end + 1 - begin);
      poses[k].R = a.R * rotation_from_vector(share * rotation_vector(a.R.transpose() * b.R));
      poses[k].p = (1.0 - share) * a.p + share * b.p;
    }
    begin = end;
  }
}

std::string list_of_missing(const std::vector<bool>& known) {
  constexpr int kLongest = 8;  // ranges named before the list is cut
  std::string ranges;
  std::size_t count = 0;
  int n_ranges = 0;
  for (std::size_t begin = 0; begin < known.size();) {
    if (known[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < known.size() && !known[end]) ++end;
    count += end - begin;
    if (++n_ranges <= kLongest) {
      ranges += join_text(ranges.empty() ? "" : ", ", begin + 1);
      if (end > begin + 1) ranges += join_text("-", end);
    }
    begin = end;
  }
  if (n_ranges > kLongest) ranges += ", …";
  return join_text(count, count == 1 ? " frame (" : " frames (", ranges, ")");
}

}  // namespace coxa::motion
