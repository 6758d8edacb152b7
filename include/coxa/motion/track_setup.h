#pragma once

#include <coxa/motion/calibration.h>
#include <coxa/motion/marker_cleaning.h>
#include <coxa/motion/track.h>

#include <optional>

namespace coxa::motion {

/// Everything that turns a raw recording into one hip's movement.
struct TrackSetup {
  Side side = Side::right;
  std::optional<HipModel> model =
      {};  ///< where absent, `calibration` makes one from anatomical markers
  CalibrationOptions calibration = {};             ///< its side is `side`
  std::map<std::string, std::string> rename = {};  ///< label in the recording -> label in the model
  Index first_frame = 0;                           ///< frames [first_frame, end_frame) are tracked
  std::optional<Index> end_frame = {};
  CleaningOptions cleaning = {};  ///< empty `segments`: the model's pelvis and thigh markers
  TrackOptions track = {};
};

struct TrackedRecording {
  TrackResult result;
  HipModel model;  ///< given or calibrated
  std::vector<JointCentre>
      centres;  ///< estimates of a calibration, pelvis frame; empty with a model given
  CleanedMarkers cleaned;
  std::vector<MarkerEvent> events;  ///< the recording's own, then those of walking that are found
};

/// Renames, calibrates where no model is given, cleans, tracks.
/// @param neutral  recording of the neutral pose to calibrate on; nullptr: the recording itself
TrackedRecording track_recording(const MarkerData& markers, const MarkerData* neutral,
                                 const TrackSetup& setup, const Monitor& monitor = {});

}  // namespace coxa::motion
