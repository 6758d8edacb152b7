#include <coxa/image/intensity.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa {
namespace {

/// Sorted copy's value at a share of its length.
double value_at_share(std::vector<float>& values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::ptrdiff_t>(at);
  std::nth_element(values.begin(), values.begin() + low, values.end());
  const double below = values[static_cast<std::size_t>(low)];
  if (low + 1 == static_cast<std::ptrdiff_t>(values.size())) return below;
  const double above = *std::min_element(values.begin() + low + 1, values.end());
  return below + (at - static_cast<double>(low)) * (above - below);
}

}  // namespace

std::vector<double> intensity_percentiles(const Volume& volume, const std::vector<double>& shares) {
  require(!volume.values.empty(), "an image without voxels has no percentiles");
  std::vector<float> values = volume.values;
  std::vector<double> result;
  for (const double share : shares) {
    require(0.0 <= share && share <= 1.0, "a share must be in [0, 1], got ", share);
    result.push_back(value_at_share(values, share));
  }
  return result;
}

double foreground_threshold(const Volume& volume) {
  double low = kInfinity, high = -kInfinity;
  for (const float value : volume.values) {
    if (value <= 0.0F) continue;
    low = std::min(low, std::log(static_cast<double>(value)));
    high = std::max(high, std::log(static_cast<double>(value)));
  }
  require(low < high, "the image has no two different positive values");
  constexpr std::size_t kBins = 256;
  std::array<double, kBins> histogram{};
  const double width = (high - low) / kBins;
  for (const float value : volume.values) {
    if (value <= 0.0F) continue;
    const auto bin = static_cast<std::size_t>((std::log(static_cast<double>(value)) - low) / width);
    histogram[std::min(bin, kBins - 1)] += 1.0;
  }
  double total = 0.0, moment = 0.0;
  for (std::size_t b = 0; b < kBins; ++b) {
    total += histogram[b];
    moment += static_cast<double>(b) * histogram[b];
  }
  double below = 0.0, moment_below = 0.0, best = -1.0;
  std::size_t best_bin = 0;
  for (std::size_t b = 0; b + 1 < kBins; ++b) {
    below += histogram[b];
    moment_below += static_cast<double>(b) * histogram[b];
    if (below <= 0.0 || below >= total) continue;
    const double difference = moment_below / below - (moment - moment_below) / (total - below);
    const double between = below * (total - below) * difference * difference;
    if (between > best) {
      best = between;
      best_bin = b;
    }
  }
  return std::exp(low + width * static_cast<double>(best_bin + 1));
}

Volume normalised(const Volume& volume, double low, double high) {
  require(0.0 <= low && low < high && high <= 1.0, "shares must be 0 <= low < high <= 1, got ", low,
          " and ", high);
  const double threshold = foreground_threshold(volume);
  Volume body;
  for (const float value : volume.values) {
    if (value > threshold) body.values.push_back(value);
  }
  const std::vector<double> ends = intensity_percentiles(body, {low, high});
  require(ends[0] < ends[1], "the image is constant: ", ends[0], " at both percentiles");
  Volume result = volume;
  for (float& value : result.values)
    value = static_cast<float>((value - ends[0]) / (ends[1] - ends[0]));
  return result;
}

}  // namespace coxa
