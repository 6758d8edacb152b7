#include <coxa/motion/calibration.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/motion/estimated_centre.h>

#include <algorithm>
#include <cmath>

namespace coxa::motion {
namespace {

using LabelledPoints = std::map<std::string, Vec3>;

struct PelvisMarkers {
  std::string asis_right, asis_left;
  std::vector<std::string> back;  // one sacral marker, or the PSIS that there are
  std::vector<std::string> all() const {
    std::vector<std::string> labels = {asis_right, asis_left};
    labels.insert(labels.end(), back.begin(), back.end());
    return labels;
  }
};

std::string all_labels(const MarkerData& markers) {
  std::string text;
  for (const std::string& label : markers.labels) text += (text.empty() ? "" : ", ") + label;
  return text;
}

const std::string& only(const MarkerRoles& roles, MarkerRole role, const MarkerData& markers) {
  const auto it = roles.find(role);
  require(it != roles.end(), "no marker for the role '", name(role),
          "'; give its label in the marker map. The recording has: ", all_labels(markers));
  return it->second.front();
}

PelvisMarkers pelvis_markers(const MarkerRoles& roles, const MarkerData& markers) {
  PelvisMarkers pelvis{only(roles, MarkerRole::asis_right, markers),
                       only(roles, MarkerRole::asis_left, markers),
                       {}};
  const auto right = roles.find(MarkerRole::psis_right), left = roles.find(MarkerRole::psis_left);
  if (right != roles.end() && left != roles.end()) {
    pelvis.back = {right->second.front(), left->second.front()};
  } else {
    pelvis.back = {only(roles, MarkerRole::sacrum, markers)};
  }
  return pelvis;
}

Vec3 at(const MarkerData& markers, const std::string& label, Index frame) {
  return markers.trajectories[static_cast<std::size_t>(*find_marker(markers, label))].row(frame);
}

// ISB pelvis frame with its origin midway between the ASIS
RigidTransform pelvis_pose(const MarkerData& markers, const PelvisMarkers& pelvis, Index frame) {
  const Vec3 right = at(markers, pelvis.asis_right, frame),
             left = at(markers, pelvis.asis_left, frame);
  Vec3 back = Vec3::Zero();
  for (const std::string& label : pelvis.back)
    back += at(markers, label, frame) / static_cast<double>(pelvis.back.size());
  return {pelvis_axes(right, left, back), 0.5 * (right + left)};
}

bool all_seen(const MarkerData& markers, const std::vector<std::string>& labels, Index frame) {
  return std::all_of(labels.begin(), labels.end(), [&](const std::string& label) {
    return seen(markers.trajectories[static_cast<std::size_t>(*find_marker(markers, label))],
                frame);
  });
}

// mean positions in the pelvis over the neutral frames in which the pelvis is seen; each label by
// its own count
LabelledPoints mean_positions(const MarkerData& markers, const PelvisMarkers& pelvis,
                              const std::vector<std::string>& labels, Index begin, Index end) {
  LabelledPoints sums;
  std::map<std::string, double> counts;
  for (Index frame = begin; frame < end; ++frame) {
    if (!all_seen(markers, pelvis.all(), frame)) continue;
    const RigidTransform X_PL = pelvis_pose(markers, pelvis, frame).inverse();
    for (const std::string& label : labels) {
      const Vec3 p = at(markers, label, frame);
      if (!p.allFinite()) continue;
      sums.try_emplace(label, Vec3::Zero()).first->second += X_PL * p;
      counts[label] += 1.0;
    }
  }
  for (auto& [label, sum] : sums) sum /= counts[label];
  return sums;
}

// the pelvis markers as the landmarks they stand on
LabelledPoints in_house_names(const LabelledPoints& means, const PelvisMarkers& pelvis) {
  LabelledPoints landmarks = {{"asis_right", means.at(pelvis.asis_right)},
                              {"asis_left", means.at(pelvis.asis_left)}};
  if (pelvis.back.size() == 1) {
    landmarks["mid_psis"] = means.at(pelvis.back.front());
  } else {
    landmarks["psis_right"] = means.at(pelvis.back[0]);
    landmarks["psis_left"] = means.at(pelvis.back[1]);
  }
  return landmarks;
}

// estimates of the joint centre from the image, from regression and, where the movement allows it,
// from function
std::vector<JointCentre> estimate_centres(const MarkerData& markers, const PelvisMarkers& pelvis,
                                          const LabelledPoints& means,
                                          const std::vector<std::string>& thigh,
                                          const CalibrationOptions& options,
                                          std::vector<std::string>& warnings) {
  const double width = (means.at(pelvis.asis_right) - means.at(pelvis.asis_left)).norm();
  Vec3 back = Vec3::Zero();
  for (const std::string& label : pelvis.back)
    back += means.at(label) / static_cast<double>(pelvis.back.size());
  const double depth =
      (0.5 * (means.at(pelvis.asis_right) + means.at(pelvis.asis_left)) - back).norm();
  std::vector<JointCentre> centres = {harrington_centre(width, depth, options.side),
                                      bell_centre(width, options.side)};

  // the first frame that shows all thigh markers is the template of the functional methods
  std::vector<RigidTransform> X_PP, X_PF;
  std::vector<Points> in_pelvis(thigh.size(), Points::Constant(markers.n_frames(), 3, kNaN));
  Points x;
  for (Index frame = 0; frame < markers.n_frames(); ++frame) {
    if (!all_seen(markers, pelvis.all(), frame)) continue;
    const RigidTransform X_PL = pelvis_pose(markers, pelvis, frame).inverse();
    Points y(static_cast<Eigen::Index>(thigh.size()), 3);
    for (std::size_t k = 0; k < thigh.size(); ++k) {
      y.row(static_cast<Eigen::Index>(k)) = X_PL * at(markers, thigh[k], frame);
      in_pelvis[k].row(frame) = y.row(static_cast<Eigen::Index>(k));
    }
    if (!y.allFinite() || thigh.size() < 3) continue;
    if (x.rows() == 0) x = y;
    X_PP.push_back({});
    X_PF.push_back(fit_rigid(x, y));
  }
  if (options.image) {
    centres.insert(centres.begin(), registered_centre(*options.image, in_house_names(means, pelvis),
                                                      options.marker_sd));
  }
  try {
    if (X_PF.size() >= 10) centres.push_back(score_centre(X_PP, X_PF));
    centres.push_back(sphere_centre(in_pelvis));
  } catch (const Error& error) {
    warnings.push_back(std::string("no functional joint centre: ") + error.what());
  }
  return centres;
}

const char* definition_of(CentreSource source) {
  switch (source) {
    case CentreSource::surfaces:
      return "surfaces";
    case CentreSource::harrington:
      return "harrington";
    case CentreSource::bell:
      return "bell";
    case CentreSource::score:
      return "score";
    case CentreSource::functional_sphere:
      return "functional_sphere";
  }
  return "unknown";
}

JointCentre chosen_centre(const std::vector<JointCentre>& centres,
                          const CalibrationOptions& options) {
  if (options.joint_centre_pelvis) {
    JointCentre given;
    given.definition = "given";
    given.centre = *options.joint_centre_pelvis;
    given.interval = 1.96 * options.joint_centre_sd;
    return given;
  }
  const char* wanted = definition_of(
      options.centre.value_or(options.image ? CentreSource::surfaces : CentreSource::harrington));
  const auto it = std::find_if(centres.begin(), centres.end(),
                               [&](const JointCentre& c) { return c.definition == wanted; });
  require(it != centres.end(), "no joint centre by '", wanted, "' from this recording");
  return *it;
}

double harrington_interval(const std::vector<JointCentre>& centres) {
  const auto it = std::find_if(centres.begin(), centres.end(),
                               [](const JointCentre& c) { return c.definition == "harrington"; });
  return it->interval;
}

struct KneeMarkers {
  std::string lateral;
  std::optional<std::string> medial;
};

KneeMarkers knee_markers(const MarkerRoles& roles, const MarkerData& markers) {
  KneeMarkers knee{only(roles, MarkerRole::knee_lateral, markers), std::nullopt};
  if (const auto medial = roles.find(MarkerRole::knee_medial); medial != roles.end())
    knee.medial = medial->second.front();
  return knee;
}

// ISB femur axes in the pelvis in one frame; nullopt where a marker is not seen
std::optional<Mat3> femur_axes_in_pelvis(const MarkerData& markers, const PelvisMarkers& pelvis,
                                         const KneeMarkers& knee, const Vec3& centre,
                                         const CalibrationOptions& options, Index frame) {
  if (!all_seen(markers, pelvis.all(), frame) || !all_seen(markers, {knee.lateral}, frame))
    return std::nullopt;
  const RigidTransform X_PL = pelvis_pose(markers, pelvis, frame).inverse();
  const Vec3 outer = X_PL * at(markers, knee.lateral, frame);
  if (knee.medial) {
    if (!all_seen(markers, {*knee.medial}, frame)) return std::nullopt;
    return femur_axes(centre, X_PL * at(markers, *knee.medial, frame), outer, options.side);
  }
  // without a medial marker the knee's axis is the pelvis' left-right axis
  const double inwards = options.side == Side::right ? -1.0 : 1.0;
  return femur_axes(centre, outer + Vec3(0, 0, 2.0 * inwards * options.knee_half_width), outer,
                    options.side);
}

// frames that show the femur's axes; without a medial marker only the one in which thigh and pelvis
// are straightest
std::map<Index, Mat3> calibration_frames(const MarkerData& markers, const PelvisMarkers& pelvis,
                                         const KneeMarkers& knee, const Vec3& centre,
                                         const CalibrationOptions& options, Index end) {
  std::map<Index, Mat3> frames;
  for (Index frame = options.first_frame; frame < end; ++frame) {
    if (const auto R_PF = femur_axes_in_pelvis(markers, pelvis, knee, centre, options, frame))
      frames[frame] = *R_PF;
  }
  require(!frames.empty(), "no calibration frame shows the pelvis and the knee at once");
  if (knee.medial) return frames;
  const auto straightest = std::max_element(
      frames.begin(), frames.end(),
      [](const auto& a, const auto& b) { return a.second(1, 1) < b.second(1, 1); });
  return {*straightest};
}

// mean positions of the thigh markers in the femur frame, from the joint centre
LabelledPoints femur_positions(const MarkerData& markers, const PelvisMarkers& pelvis,
                               const std::map<Index, Mat3>& frames, const Vec3& centre,
                               const std::vector<std::string>& thigh) {
  LabelledPoints positions;
  for (const std::string& label : thigh) {
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
    for (const auto& [frame, R_PF] : frames) {
      const Vec3 p = at(markers, label, frame);
      if (!p.allFinite()) continue;
      sum += R_PF.transpose() * (pelvis_pose(markers, pelvis, frame).inverse() * p - centre);
      count += 1.0;
    }
    if (count > 0) positions[label] = sum / count;
  }
  return positions;
}

}  // namespace

Calibration calibrate(const MarkerData& markers, const CalibrationOptions& options) {
  const Index end = options.end_frame.value_or(markers.n_frames());
  require(0 <= options.first_frame && options.first_frame < end && end <= markers.n_frames(),
          "calibration frames [", options.first_frame, ", ", end,
          ") are not in the recording, which has ", markers.n_frames(), " frames");
  require(options.knee_half_width > 0, "knee_half_width must be above 0 mm, got ",
          options.knee_half_width);
  const MarkerRoles roles =
      find_roles(markers, options.map.empty() ? default_marker_map(options.side) : options.map);
  const PelvisMarkers pelvis = pelvis_markers(roles, markers);
  std::vector<std::string> thigh =
      roles.contains(MarkerRole::thigh) ? roles.at(MarkerRole::thigh) : std::vector<std::string>{};
  for (const MarkerRole role : {MarkerRole::knee_lateral, MarkerRole::knee_medial}) {
    if (roles.contains(role)) thigh.push_back(roles.at(role).front());
  }
  const LabelledPoints means =
      mean_positions(markers, pelvis, pelvis.all(), options.first_frame, end);
  require(means.contains(pelvis.asis_right),
          "the pelvis markers are never all seen in the calibration frames");

  Calibration result;
  result.centres = estimate_centres(markers, pelvis, means, thigh, options, result.warnings);
  const JointCentre centre = chosen_centre(result.centres, options);
  const KneeMarkers knee = knee_markers(roles, markers);
  const auto frames = calibration_frames(markers, pelvis, knee, centre.centre, options, end);
  if (!knee.medial) {
    result.warnings.push_back(
        join_text("no medial knee marker: in frame ", frames.begin()->first + 1,
                  " the knee's axis is taken parallel to the pelvis' left-right axis, ",
                  options.knee_half_width, " mm from the lateral marker to its middle"));
  }
  if (centre.definition == "surfaces" && centre.interval > harrington_interval(result.centres)) {
    result.warnings.push_back(
        join_text("the surfaces' joint centre is known to ", centre.interval,
                  " mm only on the markers (pelvis landmarks of image and markers differ by ",
                  centre.rms, " mm): give the landmarks asis and psis of both sides, or choose ",
                  "joint_centre = \"harrington\""));
  }
  HipModel& model = result.model;
  model.side = options.side;
  model.joint_centre_pelvis = centre.centre;
  for (const std::string& label : pelvis.all()) model.pelvis_markers[label] = means.at(label);
  model.thigh_markers = femur_positions(markers, pelvis, frames, centre.centre, thigh);
  model.calibration_frame = frames.begin()->first;
  model.marker_sd = options.marker_sd;
  model.pelvis_centre_sd = centre.interval / 1.96;
  model.source = join_text("anatomical markers; joint centre: ", centre.definition);
  check_model(model);
  return result;
}

}  // namespace coxa::motion
