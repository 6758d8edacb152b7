#include <coxa/core/error.h>
#include <coxa/io/landmarks.h>
#include <coxa/pipeline/segment_stage.h>
#include <coxa/serve/bundle.h>

#include <algorithm>
#include <cmath>

#include "case_folder.h"

namespace coxa::serve {
namespace {
using Json = nlohmann::json;

constexpr double kSteps = 65535.0;  // of 16 bits

/// Values as q with value = low + step q: whole numbers as they are where they fit, else 16 bits
/// over the range.
struct Quantised {
  double low = 0.0, step = 1.0;
  std::vector<std::uint16_t> q;
};
Quantised quantised(const std::vector<float>& values) {
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
  bool whole = true;
  for (const float v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v), high = std::max(high, v);
    whole = whole && v == std::floor(v);
  }
  Quantised out;
  if (low > high) low = high = 0.0f;
  out.low = low;
  if (!whole || high - low > kSteps) out.step = std::max(1e-30, (double{high} - low) / kSteps);
  out.q.reserve(values.size());
  for (const float v : values)
    out.q.push_back(std::isfinite(v)
                        ? static_cast<std::uint16_t>(std::lround((v - out.low) / out.step))
                        : std::uint16_t{0});
  return out;
}

/// The values below which 1 % and 99.5 % of the voxels lie: the first window, from 1 voxel in 64.
std::array<double, 2> first_window(const std::vector<float>& values) {
  std::vector<float> some;
  for (std::size_t i = 0; i < values.size(); i += 64) {
    if (std::isfinite(values[i])) some.push_back(values[i]);
  }
  if (some.empty()) return {0.0, 1.0};
  std::sort(some.begin(), some.end());
  const auto at = [&](double share) {
    return double{some[static_cast<std::size_t>(share * static_cast<double>(some.size() - 1))]};
  };
  return {at(0.01), std::max(at(0.995), at(0.01) + 1e-6)};
}

}  // namespace

std::string CaseFolder::image() const {
  const CaseInput in = input();
  require(!in.images.empty(), in.fault);
  const auto file = landmarks_file();
  const auto landmarks = file.empty() ? shape::Landmarks{} : io::read_landmarks(file);
  Volume volume = pipeline::read_image(in.images.front(), landmarks, {});
  const auto window = first_window(volume.values);
  Quantised values = quantised(volume.values);
  volume.values = std::vector<float>();  // hundreds of megabytes that are not needed any more
  Json direction = Json::array();
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) direction.push_back(volume.direction(r, c));
  }
  Bundle bundle(Json{
      {"size", volume.size},
      {"spacing", {volume.spacing.x(), volume.spacing.y(), volume.spacing.z()}},
      {"origin", {volume.origin.x(), volume.origin.y(), volume.origin.z()}},
      {"direction_columns", direction},
      {"low", values.low},
      {"step", values.step},
      {"window",
       window}}.dump());
  bundle.add("voxels", std::span<const std::uint16_t>(values.q));
  values.q = std::vector<std::uint16_t>();
  return bundle.bytes();
}

}  // namespace coxa::serve
