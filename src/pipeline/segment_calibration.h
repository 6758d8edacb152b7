#pragma once

#include <coxa/segment/uncertainty.h>

#include <map>
#include <string>

namespace coxa::pipeline {

/// How wide the 95 % intervals of bones and cartilages are.
///
/// Fitted by tools/calibrate_uncertainty.py to the distances of eleven segmented simulated images
/// from their true surfaces (docs/segment.md tells how well it does on cases not fitted to).
const std::map<std::string, segment::Calibration>& segment_calibrations();

}  // namespace coxa::pipeline
