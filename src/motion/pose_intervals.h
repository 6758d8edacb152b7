#pragma once

#include <coxa/motion/hip_model.h>
#include <coxa/motion/hip_motion.h>
#include <coxa/motion/track.h>

#include "hip_recording.h"

namespace coxa::motion {

/// Half-widths of the 95 % intervals of the angles, per frame.
///
/// Source: docs/motion.md section 5: artefact of single markers, errors of the model, pelvis
/// markers, and the common rotation that no thigh marker shows.
std::vector<HipAngles> pose_intervals(const HipRecording& recording, const HipModel& model,
                                      const PoseEstimate& estimate, const TrackOptions& options);

}  // namespace coxa::motion
