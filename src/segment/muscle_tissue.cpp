#include "muscle_tissue.h"

#include <algorithm>

namespace coxa::segment {
namespace {

/// mm inside a body where its tissue is that of most places.
constexpr double kDeep = 3.0;
/// Brightness of what is about the bodies: this share of it is darker …
constexpr double kBrightShare = 0.9;
/// … and it must be so many spreads brighter than muscle.
constexpr double kLeastContrast = 10.0;
/// Spreads darker than muscle that are cortex, tendon or air.
constexpr double kDarkSpreads = 4.0;
/// Air: darker than this share of muscle, so many mm thick (vessels are thinner), and its border
/// looks like muscle for so many mm.
constexpr double kAirShare = 0.35, kAirThickness = 6.0, kSkin = 4.0;
/// mm. Thinner dark sheets (cortex of other bones, fascia) are not muscle; what is within the other
/// reach of thicker muscle is its edge.
constexpr double kHalfSheet = 2.0, kEdge = 3.5;
/// mm beside a found bone that are its cortex' own, unless muscle lies within the other.
constexpr double kCortex = 2.0, kBesideCortex = 2.5;

/// Within a distance of the mask.
Mask widened(const Mask& mask, const Volume& grid, double distance) {
  const std::vector<float> away = distances_to(mask, grid);
  Mask wide(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) wide[i] = away[i] < distance;
  return wide;
}

void take_away(Mask& mask, const Mask& other) {
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] &= static_cast<std::uint8_t>(other[i] == 0);
}

/// Where air is near, away from the bones, whose cortex is as dark.
Mask skin_of(const std::vector<float>& values, const Mask& bone, double level, const Volume& grid) {
  Mask dark(values.size());
  for (std::size_t i = 0; i < dark.size(); ++i)
    dark[i] = values[i] < kAirShare * level && bone[i] == 0;
  const std::vector<float> depth = depths_in(dark, grid);
  for (std::size_t i = 0; i < dark.size(); ++i) dark[i] = depth[i] > kAirThickness;
  return widened(dark, grid, kAirThickness + kSkin);
}

}  // namespace

MuscleRange muscle_range(const std::vector<float>& values, const std::vector<float>& depth,
                         const Mask& bone, double claim) {
  std::vector<double> deep, about;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (depth[i] > kDeep) deep.push_back(values[i]);
    if (depth[i] < 0.0F && depth[i] > -claim && bone[i] == 0) about.push_back(values[i]);
  }
  MuscleRange range;
  if (deep.empty() || about.empty()) return range;
  range.muscle = tissue_brightness(std::move(deep));
  const auto at = about.begin() + static_cast<std::ptrdiff_t>(kBrightShare * (about.size() - 1));
  std::nth_element(about.begin(), at, about.end());
  if (*at < range.muscle.level + kLeastContrast * range.muscle.spread) return range;
  range.low = range.muscle.level - kDarkSpreads * range.muscle.spread;
  range.high = 0.5 * (range.muscle.level + *at);
  return range;
}

Mask muscle_tissue(const std::vector<float>& values, const std::vector<float>& depth,
                   const MuscleRange& range, const Mask& bone, const Volume& grid, double claim) {
  Mask tissue(values.size());
  for (std::size_t i = 0; i < tissue.size(); ++i)
    tissue[i] =
        depth[i] > -claim && bone[i] == 0 && values[i] > range.low && values[i] < range.high;
  take_away(tissue, skin_of(values, bone, range.muscle.level, grid));
  Mask thick(values.size());
  const std::vector<float> thickness = depths_in(tissue, grid);
  for (std::size_t i = 0; i < thick.size(); ++i)
    thick[i] = thickness[i] > kHalfSheet || depth[i] > 1.0;
  const Mask edges = widened(thick, grid, kEdge), cortex = widened(bone, grid, kCortex);
  Mask beside(values.size());
  for (std::size_t i = 0; i < tissue.size(); ++i) {
    tissue[i] &= edges[i];
    beside[i] = tissue[i] != 0 && cortex[i] == 0;
  }
  const Mask reached = widened(beside, grid, kBesideCortex);
  for (std::size_t i = 0; i < tissue.size(); ++i)
    tissue[i] &= static_cast<std::uint8_t>(cortex[i] == 0 || reached[i] != 0);
  return tissue;
}

}  // namespace coxa::segment
