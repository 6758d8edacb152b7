#include <coxa/pipeline/label_map.h>

#include <coxa/mesh/voxelize.h>

#include <algorithm>

namespace coxa::pipeline {
namespace {

/// Bones first, so that a thin cartilage is not painted over.
int paint_order(const std::string& name) {
  return name.find("cartilage") == std::string::npos ? 0 : 1;
}

}  // namespace

LabelMap make_label_map(const Volume& grid, const SurfaceSet& surfaces) {
  LabelMap map;
  map.volume = grid;
  map.volume.values.assign(static_cast<std::size_t>(grid.n_voxels()), 0.0F);
  std::vector<std::string> order;
  for (const auto& [name, surface] : surfaces) order.push_back(name);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return paint_order(a) < paint_order(b); });
  for (const std::string& name : order) {
    const int label = static_cast<int>(map.labels.size()) + 1;
    map.labels[name] = label;
    const auto inside = inside_samples(surfaces.at(name).mesh, grid.size,
                                       [&](const Vec3& p) { return grid.index(p); });
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside[i] != 0) map.volume.values[i] = static_cast<float>(label);
    }
  }
  return map;
}

}  // namespace coxa::pipeline
