#include <coxa/pipeline/compare.h>

#include <coxa/core/error.h>
#include <coxa/image/volume.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>

#include <optional>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr double kViewMargin = 2.0;  // mm from the border of the image

std::map<std::string, fs::path> surfaces_in(const fs::path& place) {
  if (!fs::is_directory(place)) return {{"surface", place}};
  std::map<std::string, fs::path> found;
  for (const auto& entry : fs::directory_iterator(place)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".ply" || extension == ".vtp" || extension == ".stl") {
      found.emplace(entry.path().stem().string(), entry.path());
    }
  }
  return found;
}

}  // namespace

std::map<std::string, SurfaceDistance> compare(const fs::path& result, const fs::path& truth,
                                               const fs::path& image, const Monitor& monitor) {
  const auto results = surfaces_in(result), truths = surfaces_in(truth);
  std::optional<Volume> view;
  if (!image.empty()) view = io::read_volume(image);
  SurfaceDistanceOptions options;
  if (view) options.within = [&](const Vec3& p) { return in_view(*view, p, kViewMargin); };
  std::map<std::string, SurfaceDistance> distances;
  for (const auto& [name, path] : results) {
    const auto other = truths.find(name);
    if (other == truths.end()) continue;
    monitor.check_cancelled();
    distances[name] =
        surface_distance(io::read_surface(path), io::read_surface(other->second), options);
  }
  require(!distances.empty(), result.string(), " and ", truth.string(),
          " have no surface of the same name");
  return distances;
}

}  // namespace coxa::pipeline
