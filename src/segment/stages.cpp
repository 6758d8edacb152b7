#include "stages.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <set>

namespace coxa::segment {
std::vector<PreparedImage> smoothed_images(const std::vector<PreparedImage>& images, double sigma) {
  std::vector<PreparedImage> out = images;
  if (sigma <= 0.0) return out;
  for (PreparedImage& image : out) image.volume = smoothed(image.volume, sigma);
  return out;
}

namespace {

SurfaceSet surfaces_of(const std::vector<Body>& bodies) {
  SurfaceSet surfaces;
  for (const Body& body : bodies) surfaces[body.model->name].mesh = surface_mesh(body);
  return surfaces;
}

}  // namespace

void update_through(std::vector<Body>& bodies, const std::vector<Resolution>& resolutions,
                    const std::vector<PreparedImage>& images,
                    const std::vector<Obstacles>& obstacles, const std::vector<TriMesh>& hosts,
                    const SegmentOptions& options, const Monitor& monitor) {
  for (std::size_t r = 0; r < resolutions.size(); ++r) {
    const auto smooth = smoothed_images(images, resolutions[r].image_sigma);
    const double share = 1.0 / static_cast<double>(resolutions.size());
    const double from = static_cast<double>(r) * share;
    update_bodies(bodies, {smooth, obstacles, hosts}, resolutions[r], options,
                  part_of(monitor, "segment", from, from + share));
    if (options.on_found) options.on_found(surfaces_of(bodies));
  }
}

std::string best_contrast(const std::vector<Body>& bodies, std::span<const PreparedImage> known,
                          const PreparedImage& image, const Resolution& resolution,
                          const SegmentOptions& options) {
  if (options.contrast) return *options.contrast;
  std::set<std::string> contrasts;
  for (const shape::ProfileSet& set : bodies.front().model->profiles) {
    if (base_of(set.contrast) == base_of(image.contrast) || image.contrast.empty())
      contrasts.insert(set.contrast);
  }
  require(!contrasts.empty(), "the atlas has no intensity profiles");
  std::vector<PreparedImage> images(known.begin(), known.end());
  images.push_back(image);
  images = smoothed_images(images, resolution.image_sigma);
  std::string best;
  double best_fit = -kInfinity;
  SegmentOptions few = options;
  few.iterations = std::min(options.iterations, 6);
  for (const std::string& contrast : contrasts) {
    images.back().contrast = contrast;
    std::vector<Body> trial = bodies;
    const std::vector<Obstacles> none(trial.size());
    const std::vector<TriMesh> no_host(trial.size());
    update_bodies(trial, {images, none, no_host}, resolution, few, {});
    double fit = 0.0;
    for (const Body& body : trial) fit += body.match.here.mean();
    if (fit > best_fit) {
      best_fit = fit;
      best = contrast;
    }
  }
  return best;
}

}  // namespace coxa::segment
