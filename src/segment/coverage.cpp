#include "coverage.h"

#include <algorithm>
#include <cmath>

#include "coverage_rays.h"

namespace coxa::segment {
namespace {

// vertices this far inside and outside the present rim (mm) are taken for covered and bare
constexpr double kWellInside = 3.0, kWellOutside = 4.0;
constexpr std::size_t kFewest = 50;
// thresholds of evidence tried, and what counts as equally good (share told right)
constexpr double kLargestThreshold = 0.75, kThresholdStep = 0.25, kNearlyEqual = 0.005;
// profiles blurred more than this (mm) say less about layers of a millimetre
constexpr double kSharp = 0.75;
// evidence beyond the threshold that makes a vertex certain
constexpr double kCertain = 4.0;
// a layer thins out to its border, and less than about 0.6 mm of it vanishes between the dark
// cortex and what is dark beyond; where cartilage is brighter than marrow its glare shows, but not
// the last millimetre of a ball's, which is thinner
constexpr double kHidden = 1.0;

/// Whether the host bulges under the layer, as a ball, and is not hollow as a socket.
bool bulges(const HostPatch& patch) {
  Vec3 middle = Vec3::Zero();
  double under = 0.0;
  for (Index v = 0; v < patch.mesh.n_vertices(); ++v) {
    if (patch.rim_distance[v] <= 0.0) continue;
    middle += patch.mesh.points.row(v);
    under += 1.0;
  }
  middle /= std::max(under, 1.0);
  double outward = 0.0;
  for (Index v = 0; v < patch.mesh.n_vertices(); ++v) {
    if (patch.rim_distance[v] > 0.0)
      outward += (patch.mesh.points.row(v).transpose() - middle).dot(patch.normals.row(v));
  }
  return outward > 0.0;
}

/// The evidence that parts inside from outside best, and the mean of the shares told right.
struct Threshold {
  double value = 0.0, separation = 0.5;
};

Threshold best_threshold(std::vector<double> inside, std::vector<double> outside) {
  if (inside.size() < kFewest || outside.size() < kFewest) return {};
  std::sort(inside.begin(), inside.end());
  std::sort(outside.begin(), outside.end());
  // of nearly equally good ones the strictest: between the two a rim's fluid or fat lies
  Threshold best{0.0, -1.0};
  for (double value = -kLargestThreshold; value <= kLargestThreshold; value += kThresholdStep) {
    const auto below = [&](const std::vector<double>& sorted) {
      const auto it = std::lower_bound(sorted.begin(), sorted.end(), value);
      return static_cast<double>(it - sorted.begin()) / static_cast<double>(sorted.size());
    };
    const double right = 0.5 * (1.0 - below(inside) + below(outside));
    if (right < best.separation - kNearlyEqual) continue;
    best = {value, std::max(best.separation, right)};
  }
  return best;
}

/// Adds what one image says of one patch.
/// @returns the share told apart and the number of rays
std::pair<double, double> update_coverage(Coverage& coverage, const std::vector<CoverageRay>& rays,
                                          std::size_t patch, std::size_t image) {
  std::vector<double> inside, outside;
  for (const CoverageRay& ray : rays) {
    if (ray.patch != patch || ray.image != image) continue;
    if (ray.rim_distance > kWellInside) inside.push_back(ray.fit.evidence);
    if (ray.rim_distance < -kWellOutside) outside.push_back(ray.fit.evidence);
  }
  const Threshold threshold = best_threshold(std::move(inside), std::move(outside));
  double count = 0.0;
  for (const CoverageRay& ray : rays) {
    if (ray.patch != patch || ray.image != image) continue;
    const Index v = ray.vertex;
    const double sharpness = std::min(1.0, std::pow(kSharp / ray.blur, 2));
    coverage.score[v] =
        sharpness * std::clamp((ray.fit.evidence - threshold.value) / kCertain, -1.0, 1.0);
    coverage.bone[v] = ray.fit.bone;
    coverage.thickness[v] = ray.fit.thickness;
    coverage.known[v] = coverage.score[v] > 0.0 ? sharpness : 0.0;
    count += 1.0;
  }
  return {threshold.separation, count};
}

}  // namespace

std::vector<Coverage> coverages_of(std::span<const HostPatch> patches,
                                   std::span<const PreparedImage> images,
                                   std::span<const double> blur) {
  std::vector<CoverageRay> rays = coverage_rays(patches, images, blur);
  const std::vector<TissueBrightness> brightness = update_fits(rays, images.size());
  std::vector<Coverage> coverages;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const VecX none = VecX::Zero(patches[p].mesh.n_vertices());
    Coverage coverage{none, none, none, none};
    double sum = 0.0, total = 0.0, hidden = 0.0;
    const bool ball = bulges(patches[p]);
    for (std::size_t image = 0; image < images.size(); ++image) {
      const auto [separation, count] = update_coverage(coverage, rays, p, image);
      sum += separation * count;
      const bool dark = brightness[image].cartilage <= brightness[image].marrow;
      if (dark || ball) hidden += kHidden * count;
      total += count;
    }
    if (total > 0.0) {
      coverage.separation = sum / total;
      coverage.hidden = hidden / total;
    }
    coverages.push_back(std::move(coverage));
  }
  return coverages;
}

}  // namespace coxa::segment
