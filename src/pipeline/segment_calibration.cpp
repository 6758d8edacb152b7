#include "segment_calibration.h"

namespace coxa::pipeline {

const std::map<std::string, segment::Calibration>& segment_calibrations() {
  static const std::map<std::string, segment::Calibration> calibrations = {
      {"femur",
       {.constant = -0.017,
        .doubt = 0.898,
        .border = 0.889,
        .edge = 0.211,
        .blur = -0.073,
        .beyond = 2.217,
        .growth = 0.061}},
      {"hip_bone",
       {.constant = 0.637,
        .doubt = 1.045,
        .border = 1.361,
        .edge = -0.117,
        .blur = -0.131,
        .beyond = 2.217,
        .growth = 0.061}},
      {"femoral_cartilage",
       {.constant = -1.730,
        .doubt = 0.108,
        .blur = 0.625,
        .rim = 0.706,
        .far_side = 0.941,
        .beyond = 2.217,
        .growth = 0.061}},
      {"acetabular_cartilage",
       {.constant = -1.397,
        .doubt = 0.229,
        .blur = 0.330,
        .rim = 1.880,
        .far_side = 0.774,
        .beyond = 2.217,
        .growth = 0.061}},
  };
  return calibrations;
}

}  // namespace coxa::pipeline
