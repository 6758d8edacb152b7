#pragma once

#include <cmath>

namespace coxa::segment {

/// Share of the way past an edge at `at` of a place at s, blurred by a Gaussian of that standard
/// deviation; all mm.
inline double past(double s, double at, double blur) {
  return 0.5 * std::erfc(-(s - at) / (std::sqrt(2.0) * blur));
}

}  // namespace coxa::segment
