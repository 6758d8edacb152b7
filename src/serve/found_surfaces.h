#pragma once

#include <coxa/mesh/surface_set.h>

#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace coxa::serve {

/// Surfaces as far as a segmentation under way has found them, as bundles. The run's thread sets
/// them, requests read them.
class FoundSurfaces {
 public:
  /// Takes the place of those of the same names.
  void set(const SurfaceSet& surfaces);
  void clear();
  /// Bundle of positions and triangles; nullopt where nothing is found yet.
  std::optional<std::string> bundle(const std::string& structure) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> bundles_;
};

}  // namespace coxa::serve
