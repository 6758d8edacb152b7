#pragma once

#include <coxa/motion/hip_model.h>
#include <coxa/motion/hip_motion.h>
#include <coxa/motion/track.h>

#include "artefact_model.h"
#include "hip_recording.h"

namespace coxa::motion {

/// Half-widths of the 95 % intervals of the angles, per frame.
///
/// @param artefact      as the trial shows it, whatever the method
/// @param registration  rad², error common to all frames where the marker positions were put right
///                      by the calibration frame; nullopt: they carry the model's marker_sd
/// Source: docs/motion.md section 5.
std::vector<HipAngles> pose_intervals(const HipRecording& recording, const HipModel& model,
                                      const PoseEstimate& estimate, const ArtefactModel& artefact,
                                      const std::optional<Mat3>& registration,
                                      const TrackOptions& options);

}  // namespace coxa::motion
