#include "found_surfaces.h"

#include <coxa/serve/bundle.h>

#include <nlohmann/json.hpp>

namespace coxa::serve {

void FoundSurfaces::set(const SurfaceSet& surfaces) {
  std::map<std::string, std::string> bundles;
  for (const auto& [name, surface] : surfaces) {
    Bundle bundle(nlohmann::json{{"name", name}}.dump());
    bundle.add("positions", surface.mesh.points);
    bundle.add("triangles", surface.mesh.triangles);
    bundles[name] = bundle.bytes();
  }
  const std::lock_guard lock(mutex_);
  for (auto& [name, bytes] : bundles) bundles_[name] = std::move(bytes);
}

void FoundSurfaces::clear() {
  const std::lock_guard lock(mutex_);
  bundles_.clear();
}

std::optional<std::string> FoundSurfaces::bundle(const std::string& structure) const {
  const std::lock_guard lock(mutex_);
  const auto found = bundles_.find(structure);
  return found == bundles_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace coxa::serve
