#pragma once

#include <coxa/core/monitor.h>
#include <coxa/motion/bone_frames.h>
#include <coxa/motion/hip_motion.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/motion/track_setup.h>
#include <coxa/pipeline/stage.h>
#include <coxa/pipeline/subject.h>

#include <filesystem>
#include <optional>

namespace coxa::pipeline {

/// What the motion stage found.
struct MotionArtefacts {
  motion::HipMotion motion;   ///< the frames that are simulated
  motion::BoneFrames frames;  ///< of pelvis and femur in the image, origins at the joint centre
};

/// Joint centre and bone frames from the surfaces, and the femur's pose per frame, into `folder`:
/// motion.csv, motion.mot, frames.json, frame_landmarks.mrk.json, joint_centres.csv and the record
/// motion.json.
Record run_motion_stage(const Subject& subject, const std::filesystem::path& segment_folder,
                        const std::filesystem::path& folder, Reuse reuse, const Monitor& monitor);

/// Reads them back. @throws Error bad_file if they are not there
MotionArtefacts read_motion_artefacts(const std::filesystem::path& folder, Side side);

/// A recording and what is needed to track it.
struct TrackInputs {
  std::filesystem::path markers;
  std::filesystem::path config = {};  ///< TOML, or a hip model as JSON; empty: markers are told by
                                      ///< their labels, and the recording's own frames calibrate
  std::filesystem::path model = {};   ///< hip model, JSON; wins over the configuration's; or empty
  std::optional<Side> side = {};  ///< what the configuration must be for; nullopt: whatever it says
  /// Joint centre and landmarks of the patient's surfaces: where no hip model is given, the
  /// calibration pins the head there, unless the configuration names another centre.
  std::optional<motion::ImagedPelvis> image = {};
};
/// Reads a recording and tracks it as the configuration says.
motion::TrackedRecording track_markers(const TrackInputs& inputs, const Monitor& monitor);

/// The pattern's file: `pattern` itself where it is one, else data/movements/<pattern>.toml.
/// @throws Error bad_input listing the movements there are
std::filesystem::path movement_file(const std::string& pattern);

}  // namespace coxa::pipeline
