#include <algorithm>
#include <cmath>

#include "frame_figures.h"

namespace coxa::joint {
namespace {

std::vector<collide::ContactSample> pressed(const std::vector<collide::ContactSample>& samples) {
  std::vector<collide::ContactSample> kept;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(kept),
               [](const collide::ContactSample& sample) { return sample.pressure > 0.0; });
  return kept;
}

}  // namespace

double pressure_percentile(const std::vector<collide::ContactSample>& samples, double share) {
  std::vector<collide::ContactSample> sorted = pressed(samples);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.pressure < b.pressure; });
  double total = 0.0, below = 0.0;
  for (const auto& sample : sorted) total += sample.area;
  for (const auto& sample : sorted) {
    below += sample.area;
    if (below >= share * total) return sample.pressure;
  }
  return sorted.empty() ? 0.0 : sorted.back().pressure;
}

double patch_peak(const std::vector<collide::ContactSample>& samples, double area) {
  const std::vector<collide::ContactSample> kept = pressed(samples);
  const double squared_radius = area / kPi;
  double peak = 0.0;
  for (const auto& centre : kept) {
    double force = 0.0, covered = 0.0;
    for (const auto& sample : samples) {
      if ((sample.point - centre.point).squaredNorm() > squared_radius) continue;
      force += sample.pressure * sample.area;
      covered += sample.area;
    }
    // where the surface ends within the disc, the rest of the patch carries nothing
    peak = std::max(peak, force / std::max(covered, 0.75 * area));
  }
  return peak;
}

}  // namespace coxa::joint
