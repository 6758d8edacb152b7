#include "segment_calibration.h"

namespace coxa::pipeline {

const std::map<std::string, segment::Calibration>& segment_calibrations() {
  static const std::map<std::string, segment::Calibration> calibrations = {
      {"femur",
       {.constant = 0.048,
        .doubt = 0.689,
        .border = 0.863,
        .edge = 0.244,
        .blur = 0.069,
        .beyond = 2.141,
        .growth = 0.094}},
      {"hip_bone",
       {.constant = 0.548,
        .doubt = 1.027,
        .border = 1.299,
        .edge = -0.080,
        .blur = -0.164,
        .beyond = 2.141,
        .growth = 0.094}},
      {"femoral_cartilage",
       {.constant = -1.746,
        .doubt = 0.155,
        .blur = 0.960,
        .rim = 0.865,
        .far_side = 0.898,
        .beyond = 2.141,
        .growth = 0.094}},
      {"acetabular_cartilage",
       {.constant = -1.360,
        .doubt = 0.294,
        .blur = 0.382,
        .rim = 1.924,
        .far_side = 0.657,
        .beyond = 2.141,
        .growth = 0.094}},
  };
  return calibrations;
}

}  // namespace coxa::pipeline
