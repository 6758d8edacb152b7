#include <coxa/motion/track_setup.h>

#include <coxa/core/error.h>
#include <coxa/motion/gait_events.h>

namespace coxa::motion {
namespace {

MarkerData renamed(MarkerData markers, const std::map<std::string, std::string>& names) {
  for (const auto& [from, to] : names) {
    const auto marker = find_marker(markers, from);
    if (!marker) {
      markers.warnings.push_back("the label '" + from + "' to be renamed is not in the recording");
      continue;
    }
    const auto taken = find_marker(markers, to);
    require(!taken || *taken == *marker, "'", from, "' cannot be renamed to '", to,
            "': the recording has that label already");
    markers.labels[static_cast<std::size_t>(*marker)] = to;
  }
  return markers;
}

std::vector<std::string> labels_of(const std::map<std::string, Vec3>& markers) {
  std::vector<std::string> labels;
  for (const auto& [label, position] : markers) labels.push_back(label);
  return labels;
}

}  // namespace

TrackedRecording track_recording(const MarkerData& markers, const MarkerData* neutral,
                                 const TrackSetup& setup, const Monitor& monitor) {
  TrackedRecording outcome;
  const MarkerData recording = renamed(markers, setup.rename);
  std::vector<std::string> warnings;
  if (setup.model) {
    outcome.model = *setup.model;
  } else {
    CalibrationOptions options = setup.calibration;
    options.side = setup.side;
    Calibration calibration =
        calibrate(neutral ? renamed(*neutral, setup.rename) : recording, options);
    outcome.model = std::move(calibration.model);
    outcome.centres = std::move(calibration.centres);
    warnings = std::move(calibration.warnings);
    if (neutral) outcome.model.calibration_frame.reset();
  }

  CleaningOptions cleaning = setup.cleaning;
  if (cleaning.segments.empty()) {
    cleaning.segments = {labels_of(outcome.model.pelvis_markers),
                         labels_of(outcome.model.thigh_markers)};
  }
  outcome.cleaned = clean_markers(recording, cleaning);
  outcome.events = recording.events;
  const FoundEvents found = find_gait_events(outcome.cleaned.markers);
  outcome.events.insert(outcome.events.end(), found.events.begin(), found.events.end());

  // the calibration frame is counted in the whole recording: it moves with the part that is tracked
  const Index end = setup.end_frame.value_or(recording.n_frames());
  HipModel model = outcome.model;
  if (model.calibration_frame) {
    const Index frame = *model.calibration_frame - setup.first_frame;
    if (frame < 0 || *model.calibration_frame >= end) {
      model.calibration_frame.reset();
    } else {
      model.calibration_frame = frame;
    }
  }
  outcome.result = track_in_detail(frames_between(outcome.cleaned.markers, setup.first_frame, end),
                                   model, setup.track, monitor);
  auto& all = outcome.result.motion.warnings;
  all.insert(all.begin(), warnings.begin(), warnings.end());
  return outcome;
}

}  // namespace coxa::motion
