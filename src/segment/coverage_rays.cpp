#include "coverage_rays.h"

#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace coxa::segment {
namespace {

const ProfileGrid kGrid;
// samples up to here, mm, are in the marrow
constexpr double kMarrowUpTo = -2.5;
// the darkest sample of the cortex lies from there up to here, mm
constexpr double kCortexUpTo = 1.0;
// this far beyond it, mm, a profile is in the cartilage
constexpr double kIntoCartilage = 1.5;
// deviation of the layered model from a profile without noise, share of the contrast
constexpr double kModelError = 0.06;
// the cartilage's brightness is known so well before and after a first fit (relative)
constexpr double kFirstSpread = 0.3, kSecondSpread = 0.06;
// fits of clear layers at least this thick (mm) and this much likelier than bare bone tell it; a
// dark cartilage's brightness shows only where the layer is thicker than the blur
constexpr double kThickEnough = 1.2, kThickEnoughDark = 2.0, kClear = 3.0;
constexpr std::size_t kFewest = 50, kEnough = 200;
// brightnesses tried, as shares of the first guess
constexpr double kLowestShare = 0.8, kHighestShare = 1.7, kShareStep = 1.06;
// blurs are told apart in steps of this, mm
constexpr double kBlurStep = 0.1;

/// Brightnesses of the tissues as the profiles beneath the present layers show them.
std::optional<TissueBrightness> first_brightness(const std::vector<CoverageRay>& rays,
                                                 std::size_t image) {
  const Index n_marrow = kGrid.index_at(kMarrowUpTo) + 1,
              cortex_end = kGrid.index_at(kCortexUpTo) + 1;
  const Index into = kGrid.index_at(kIntoCartilage) - kGrid.index_at(0.0);
  std::vector<double> marrow, darkest, cartilage, variance;
  for (const CoverageRay& ray : rays) {
    if (ray.image != image || ray.rim_distance <= 0.0) continue;
    const VecX& y = ray.profile;
    const double mean = y.head(n_marrow).mean();
    Index at = 0;
    darkest.push_back(y.segment(n_marrow, cortex_end - n_marrow).minCoeff(&at));
    marrow.push_back(mean);
    cartilage.push_back(y[n_marrow + at + into]);
    variance.push_back((y.head(n_marrow).array() - mean).square().mean());
  }
  if (marrow.size() < kFewest) return std::nullopt;
  TissueBrightness b;
  b.marrow = quantile(marrow, 0.5);
  b.cortex = quantile(darkest, 0.1);
  b.cartilage = quantile(cartilage, 0.5);
  const double contrast = std::max(std::abs(b.marrow - b.cortex), std::abs(b.cartilage - b.cortex));
  b.noise = std::hypot(std::sqrt(quantile(variance, 0.5)), kModelError * contrast);
  b.cartilage_deviation = kFirstSpread * std::abs(b.cartilage);
  return b.noise > 0.0 ? std::optional(b) : std::nullopt;
}

/// Models for every blur that rays of an image have.
class Models {
 public:
  Models(const std::vector<CoverageRay>& rays, std::size_t image,
         const TissueBrightness& brightness) {
    for (const CoverageRay& ray : rays) {
      const long step = step_of(ray);
      if (ray.image == image && !models_.contains(step))
        models_.emplace(step, LayerModel(brightness, static_cast<double>(step) * kBlurStep, kGrid));
    }
  }
  LayerFit fit(const CoverageRay& ray) const { return models_.at(step_of(ray)).fit(ray.profile); }

 private:
  static long step_of(const CoverageRay& ray) {
    return std::max(1L, std::lround(ray.blur / kBlurStep));
  }
  std::map<long, LayerModel> models_;
};

void update_fits_in(std::vector<CoverageRay>& rays, std::size_t image,
                    const TissueBrightness& brightness) {
  const Models models(rays, image, brightness);
  parallel_for(static_cast<std::int64_t>(rays.size()), [&](Index i) {
    CoverageRay& ray = rays[static_cast<std::size_t>(i)];
    if (ray.image == image) ray.fit = models.fit(ray);
  });
}

/// Some rays beneath a clear layer. What is brighter beyond a bright cartilage is fluid, whose
/// glare counts into a thin layer's: these are left out.
std::vector<CoverageRay> telling_rays(const std::vector<CoverageRay>& rays, std::size_t image,
                                      const TissueBrightness& brightness) {
  const double thick = brightness.cartilage > brightness.marrow ? kThickEnough : kThickEnoughDark;
  std::vector<CoverageRay> telling;
  for (const CoverageRay& ray : rays) {
    if (ray.image != image || ray.rim_distance <= 0.0) continue;
    const LayerFit& fit = ray.fit;
    const bool beside_fluid =
        brightness.cartilage > brightness.marrow && fit.beyond > fit.cartilage;
    if (!beside_fluid && fit.thickness >= thick && fit.evidence > kClear) telling.push_back(ray);
  }
  if (telling.size() < kFewest) return {};
  const std::size_t stride = (telling.size() + kEnough - 1) / kEnough;
  std::vector<CoverageRay> some;
  for (std::size_t i = 0; i < telling.size(); i += stride) some.push_back(telling[i]);
  return some;
}

/// The brightness of cartilage with which the layered model leaves least of the telling rays
/// unexplained. (The mean of their own would be too low: a thin layer's brightness can be traded
/// for its thickness.)
double likeliest_cartilage(const std::vector<CoverageRay>& telling, std::size_t image,
                           TissueBrightness brightness) {
  const double first = brightness.cartilage;
  double best = first, least = kInfinity;
  for (double share = kLowestShare; share <= kHighestShare && !telling.empty();
       share *= kShareStep) {
    brightness.cartilage = share * first;
    brightness.cartilage_deviation = kSecondSpread * brightness.cartilage;
    const Models models(telling, image, brightness);
    const double cost = parallel_reduce(
        static_cast<std::int64_t>(telling.size()), 0.0,
        [&](Index i) { return models.fit(telling[static_cast<std::size_t>(i)]).cost; },
        [](double a, double b) { return a + b; });
    if (cost >= least) continue;
    least = cost;
    best = brightness.cartilage;
  }
  return best;
}

}  // namespace

double blur_along(const Volume& volume, const Vec3& normal) {
  return 0.5 * volume.spacing.cwiseProduct(volume.direction.transpose() * normal).norm();
}

double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::vector<CoverageRay> coverage_rays(std::span<const HostPatch> patches,
                                       std::span<const PreparedImage> images,
                                       std::span<const double> blurs) {
  std::vector<CoverageRay> rays;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const HostPatch& patch = patches[p];
    std::vector<CoverageRay> found(static_cast<std::size_t>(patch.mesh.n_vertices()));
    parallel_for(patch.mesh.n_vertices(), [&](Index v) {
      CoverageRay& ray = found[static_cast<std::size_t>(v)];
      ray.patch = p;
      ray.vertex = v;
      ray.rim_distance = patch.rim_distance[v];
      const Vec3 place = patch.mesh.points.row(v), normal = patch.normals.row(v);
      for (std::size_t i = 0; i < images.size(); ++i) {
        const double blur = blurs[i] * blur_along(images[i].volume, normal);
        if (ray.profile.size() > 0 && ray.blur <= blur) continue;
        auto values = profile_along(images[i].volume, place, normal, kGrid);
        if (!values) continue;
        ray.profile = std::move(*values);
        ray.blur = blur;
        ray.image = i;
      }
    });
    std::erase_if(found, [](const CoverageRay& ray) { return ray.profile.size() == 0; });
    std::move(found.begin(), found.end(), std::back_inserter(rays));
  }
  return rays;
}

std::vector<TissueBrightness> update_fits(std::vector<CoverageRay>& rays, std::size_t n_images) {
  std::vector<TissueBrightness> all(n_images);
  for (std::size_t image = 0; image < n_images; ++image) {
    auto brightness = first_brightness(rays, image);
    if (!brightness) {
      std::erase_if(rays, [&](const CoverageRay& ray) { return ray.image == image; });
      continue;
    }
    update_fits_in(rays, image, *brightness);
    brightness->cartilage =
        likeliest_cartilage(telling_rays(rays, image, *brightness), image, *brightness);
    brightness->cartilage_deviation = kSecondSpread * std::abs(brightness->cartilage);
    update_fits_in(rays, image, *brightness);
    all[image] = *brightness;
  }
  return all;
}

}  // namespace coxa::segment
