#include <coxa/pipeline/motion_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/markers.h>
#include <coxa/io/motion_files.h>
#include <coxa/io/movement_files.h>
#include <coxa/io/track_config.h>
#include <coxa/io/track_model.h>
#include <coxa/motion/clinical_pattern.h>
#include <coxa/pipeline/completed_bones.h>
#include <coxa/pipeline/frame_picture.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/view/png.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {
using Json = nlohmann::json;

Json as_json(const motion::BoneFrame& frame) {
  Json axes = Json::array();
  for (int c = 0; c < 3; ++c) {
    axes.push_back({frame.X_IB.R(0, c), frame.X_IB.R(1, c), frame.X_IB.R(2, c)});
  }
  return {{"origin_lps_mm", {frame.X_IB.p.x(), frame.X_IB.p.y(), frame.X_IB.p.z()}},
          {"axes_anterior_superior_right", axes},
          {"source", frame.source},
          {"interval_deg", degrees(frame.interval)}};
}

motion::BoneFrame frame_from(const Json& json) {
  motion::BoneFrame frame;
  for (int r = 0; r < 3; ++r) {
    frame.X_IB.p[r] = json.at("origin_lps_mm").at(r).get<double>();
    for (int c = 0; c < 3; ++c) {
      frame.X_IB.R(r, c) = json.at("axes_anterior_superior_right").at(c).at(r).get<double>();
    }
  }
  frame.source = json.at("source").get<std::string>();
  frame.interval = radians(json.at("interval_deg").get<double>());
  return frame;
}

Record wanted_record(const Subject& subject, const fs::path& segment_folder) {
  Record record;
  record.verb = "motion";
  record.options = {{"side", std::string(subject.side == Side::left ? "left" : "right")},
                    {"frames", std::int64_t{subject.motion.frames}}};
  record.inputs["segment"] = record_key(read_record(segment_folder / "segment.json"));
  if (!subject.landmarks.empty())
    record.inputs["landmarks"] = io::sha256_of_path(subject.landmarks);
  if (!subject.motion.landmarks.empty())
    record.inputs["frame_landmarks"] = io::sha256_of_path(subject.motion.landmarks);
  record.inputs["atlas"] = io::sha256_of_path(subject.atlas);
  if (subject.motion.from) record.options["from_s"] = *subject.motion.from;
  if (subject.motion.to) record.options["to_s"] = *subject.motion.to;
  if (subject.motion.pattern.empty()) {
    record.inputs["markers"] = io::sha256_of_path(subject.motion.markers);
    if (!subject.motion.config.empty())
      record.inputs["config"] = io::sha256_of_path(subject.motion.config);
  } else {
    record.inputs["movement"] = io::sha256_of_path(movement_file(subject.motion.pattern));
  }
  return record;
}

/// At most `entry.frames` frames spread evenly over the part of the motion that the entry chooses,
/// its first and last among them.
motion::HipMotion thinned(const motion::HipMotion& all, const MotionEntry& entry) {
  const auto begin =
      std::lower_bound(all.time.begin(), all.time.end(), entry.from.value_or(-kInfinity));
  const auto end = std::upper_bound(begin, all.time.end(), entry.to.value_or(kInfinity));
  const auto first = begin - all.time.begin(), n = end - begin;
  require(n > 0, "from_s and to_s leave no frame: the recording lasts from ", all.time.front(),
          " to ", all.time.back(), " s");
  const auto count = std::min<std::ptrdiff_t>(entry.frames, n);
  motion::HipMotion few;
  few.method = all.method;
  few.warnings = all.warnings;
  few.head_lab.resize(all.head_lab.rows() > 0 ? count : 0, 3);
  for (Index i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
    const auto k =
        static_cast<std::size_t>(first + std::lround(share * static_cast<double>(n - 1)));
    few.time.push_back(all.time[k]);
    few.angles.push_back(all.angles[k]);
    few.X_PF.push_back(all.X_PF[k]);
    if (!all.interval.empty()) few.interval.push_back(all.interval[k]);
    if (few.head_lab.rows() > 0) few.head_lab.row(i) = all.head_lab.row(static_cast<Index>(k));
  }
  return few;
}

// what the surfaces tell the calibration of a recording; nullopt where too few pelvis landmarks are
// known to lay the image on the markers
std::optional<motion::ImagedPelvis> imaged_pelvis(const motion::JointCentre& centre,
                                                  const motion::BoneFrames& frames) {
  motion::ImagedPelvis image{.joint_centre = centre.centre,
                             .joint_centre_sd = centre.interval / 1.96};
  for (const auto& [name, p] : frames.landmarks) {
    if (name.starts_with("asis") || name.starts_with("psis")) image.landmarks[name] = p;
  }
  if (image.landmarks.size() < 3) return std::nullopt;
  if (frames.pelvis.source.find("completion") != std::string::npos)
    image.landmark_sd = kCompletedLandmarkSd;
  return image;
}

motion::HipMotion make_motion(const Subject& subject, const fs::path& folder,
                              const motion::JointCentre& centre, const motion::BoneFrames& frames,
                              Record& record, const Monitor& monitor) {
  if (!subject.motion.pattern.empty()) {
    const auto pattern = io::read_pattern(movement_file(subject.motion.pattern));
    return motion::make_movement(pattern, subject.side, {.n_frames = subject.motion.frames});
  }
  const motion::TrackedRecording tracked = track_markers({.markers = subject.motion.markers,
                                                          .config = subject.motion.config,
                                                          .side = subject.side,
                                                          .image = imaged_pelvis(centre, frames)},
                                                         monitor);
  record.figures["tracked_about"] = tracked.model.source;
  if (!tracked.centres.empty())
    io::write_joint_centres(folder / "joint_centres_of_markers.csv", tracked.centres);
  if (!tracked.events.empty()) io::write_events(folder / "events.csv", tracked.events);
  io::write_motion(folder / "tracked.csv", tracked.result.motion);
  io::write_residuals(folder / "residuals.csv", tracked.result);
  return thinned(tracked.result.motion, subject.motion);
}

void add_figures(const motion::JointCentreResult& centre, const motion::BoneFrames& frames,
                 Record& record) {
  record.figures["femoral_head_radius_mm"] = centre.chosen.radius;
  record.figures["femoral_head_rms_mm"] = centre.chosen.rms;
  record.figures["joint_centre_definition"] = centre.chosen.definition;
  record.figures["joint_centre_interval_mm"] = centre.chosen.interval;
  record.figures["joint_centre_spread_mm"] = centre.largest_spread;
  record.figures["pelvis_frame_source"] = frames.pelvis.source;
  record.figures["pelvis_frame_interval_deg"] = degrees(frames.pelvis.interval);
  record.figures["femur_frame_source"] = frames.femur.source;
  record.figures["femur_frame_interval_deg"] = degrees(frames.femur.interval);
}

}  // namespace

motion::TrackedRecording track_markers(const TrackInputs& inputs, const Monitor& monitor) {
  io::TrackConfig setup;
  if (!inputs.config.empty()) setup = io::read_track_config(inputs.config);
  if (!inputs.model.empty()) {
    setup.setup.model = io::read_hip_model(inputs.model);
    setup.setup.side = setup.setup.model->side;
  }
  const bool nothing_known = inputs.config.empty() && inputs.model.empty();
  if (nothing_known && inputs.side) setup.setup.side = *inputs.side;
  require(!inputs.side || setup.setup.side == *inputs.side,
          (inputs.model.empty() ? inputs.config : inputs.model).string(), " is for the ",
          setup.setup.side == Side::left ? "left" : "right",
          " hip, the subject file for the other");
  setup.setup.calibration.image = inputs.image;
  const motion::MarkerData recording = io::read_markers(inputs.markers);
  for (const std::string& text : recording.warnings) monitor.warn(text);
  if (!setup.neutral_trial)
    return motion::track_recording(recording, nullptr, setup.setup, monitor);
  const motion::MarkerData neutral = io::read_markers(*setup.neutral_trial);
  return motion::track_recording(recording, &neutral, setup.setup, monitor);
}

fs::path movement_file(const std::string& pattern) {
  if (fs::is_regular_file(pattern)) return pattern;
  const fs::path folder = shipped_data("movements");
  const fs::path shipped = folder / (pattern + ".toml");
  if (fs::exists(shipped)) return shipped;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  fail(ErrorCode::bad_input, "there is no movement \"", pattern, "\": neither a file nor one of ",
       known);
}

Record run_motion_stage(const Subject& subject, const fs::path& segment_folder,
                        const fs::path& folder, Reuse reuse, const Monitor& monitor) {
  const auto body = [&](const fs::path& partial, Record& record) {
    const SurfaceSet surfaces = read_surfaces(segment_folder);
    const auto centre =
        motion::find_joint_centre(surfaces, joint_centre_options(subject.side), monitor);
    motion::FrameLandmarks landmarks;
    if (!subject.landmarks.empty()) landmarks.points = io::read_landmarks(subject.landmarks);
    if (!subject.motion.landmarks.empty()) {
      for (const auto& [name, p] : io::read_landmarks(subject.motion.landmarks))
        landmarks.points[name] = p;
    }
    const auto frames = make_completed_frames(surfaces, landmarks, io::read_atlas(subject.atlas),
                                              centre.chosen.centre, subject.side);
    monitor.progress("motion", 0.3);
    const motion::HipMotion motion =
        make_motion(subject, partial, centre.chosen, frames, record, monitor);
    io::write_motion(partial / "motion.csv", motion);
    io::write_opensim_motion(partial / "motion.mot", motion, subject.side);
    io::write_bytes(
        partial / "frames.json",
        Json{{"pelvis", as_json(frames.pelvis)}, {"femur", as_json(frames.femur)}}.dump(2) + "\n");
    io::write_joint_centres(partial / "joint_centres.csv", centre.all);
    if (!frames.landmarks.empty())
      io::write_landmarks(partial / "frame_landmarks.mrk.json", frames.landmarks);
    view::write_png(partial / "frames.png", draw_bone_frames(surfaces, frames, subject.side));
    add_figures(centre, frames, record);
    for (const auto* list : {&centre.warnings, &frames.warnings, &motion.warnings}) {
      record.warnings.insert(record.warnings.end(), list->begin(), list->end());
    }
  };
  return run_stage(folder, wanted_record(subject, segment_folder), reuse, monitor, body);
}

MotionArtefacts read_motion_artefacts(const fs::path& folder, Side side) {
  MotionArtefacts artefacts;
  artefacts.motion = io::read_motion(folder / "motion.csv", side);
  try {
    const Json json = Json::parse(io::read_bytes(folder / "frames.json"));
    artefacts.frames.pelvis = frame_from(json.at("pelvis"));
    artefacts.frames.femur = frame_from(json.at("femur"));
  } catch (const Json::exception& error) {
    fail(ErrorCode::bad_file, (folder / "frames.json").string(),
         " is not what coxa wrote: ", error.what());
  }
  return artefacts;
}

}  // namespace coxa::pipeline
