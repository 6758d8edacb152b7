#include <coxa/pipeline/label_map.h>

#include <coxa/mesh/voxelize.h>
#include <coxa/pipeline/muscle_names.h>
#include <coxa/pipeline/structures.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace coxa::pipeline {
namespace {

std::optional<std::size_t> muscle_number(const std::string& name) {
  const auto& names = muscle_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

/// Muscles first, then bones, so that a thin cartilage is not painted over.
int paint_order(const std::string& name) {
  if (muscle_number(name)) return 0;
  if (is_generic(name)) return 1;
  return name.find("cartilage") == std::string::npos ? 2 : 3;
}

/// Colours that 3D Slicer users know: bones ivory and sand, cartilages blue and teal.
std::array<double, 3> colour_of(const std::string& name) {
  if (name == "femur") return {0.95, 0.84, 0.57};
  if (name == "hip_bone") return {0.87, 0.74, 0.62};
  if (name == "femoral_cartilage") return {0.26, 0.55, 0.86};
  if (name == "acetabular_cartilage") return {0.12, 0.68, 0.60};
  if (name == "acetabular_labrum") return {0.80, 0.47, 0.65};
  if (is_generic(name)) return {0.85, 0.80, 0.55};
  if (const auto muscle = muscle_number(name)) {
    // reds that neighbours in the list do not share
    const double shade = static_cast<double>((*muscle * 7) % 13) / 13.0;
    return {0.55 + 0.4 * shade, 0.15 + 0.25 * (1.0 - shade), 0.2 + 0.2 * shade};
  }
  return {0.6, 0.6, 0.6};
}

}  // namespace

io::LabelMap make_label_map(const Volume& grid, const SurfaceSet& surfaces) {
  io::LabelMap map;
  map.volume = grid;
  map.volume.values.assign(static_cast<std::size_t>(grid.n_voxels()), 0.0F);
  std::vector<std::string> order;
  for (const auto& [name, surface] : surfaces) order.push_back(name);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return paint_order(a) < paint_order(b); });
  for (const std::string& name : order) {
    const int label = static_cast<int>(map.labels.size()) + 1;
    map.labels.push_back({label, name, colour_of(name), is_generic(name)});
    const auto inside = inside_samples(surfaces.at(name).mesh, grid.size,
                                       [&](const Vec3& p) { return grid.index(p); });
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside[i] != 0) map.volume.values[i] = static_cast<float>(label);
    }
  }
  return map;
}

}  // namespace coxa::pipeline
