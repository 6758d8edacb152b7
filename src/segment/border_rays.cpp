#include "border_rays.h"

#include <coxa/core/parallel.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "coverage_rays.h"

namespace coxa::segment {
namespace {

// samples between these, mm, are in the marrow where the cortex is not thick; the darkest of the
// cortex lies between the second and the third, and is darker than marrow by at least so much
// (share)
constexpr double kMarrowFrom = -5.0, kMarrowUpTo = -3.0, kCortexUpTo = 1.0;
constexpr double kDarkShare = 0.1, kDarkest = 0.7;
// what is outside is brighter than cortex by this share of the contrast of marrow and cortex
constexpr double kDarkAbove = 0.2;
// deviation of the model from a profile without noise, share of the contrast
constexpr double kModelError = 0.05;
// clear rays: a band at least this wide, mm, something at least this bright outside (share of the
// marrow), a border told to this, mm
constexpr double kClearBand = 0.8, kClearOutside = 0.6, kClearDeviation = 0.5;
constexpr std::size_t kFewest = 50, kEnough = 150;
// a model never is so good (mean squared residual, first guess of the noise)
constexpr double kLeastMisfit = 0.02;
// cortices as shares of the darkest seen, and blurs as shares of half a voxel, that are tried
constexpr double kCortexShare[] = {0.4, 0.6, 0.8, 1.0, 1.2};
constexpr double kBlurShare[] = {0.85, 1.0, 1.15, 1.3, 1.45, 1.6, 1.75};
// blurs are told apart in steps of this, mm
constexpr double kBlurStep = 0.05;

using Rays = std::vector<BorderRay>;

Rays of_image(const std::vector<Rays>& bones, std::size_t image) {
  Rays own;
  for (const Rays& rays : bones) {
    for (const BorderRay& ray : rays) {
      if (ray.image == image) own.push_back(ray);
    }
  }
  return own;
}

Rays every_nth(const Rays& rays, std::size_t enough) {
  const std::size_t stride = std::max<std::size_t>(1, (rays.size() + enough - 1) / enough);
  Rays some;
  for (std::size_t i = 0; i < rays.size(); i += stride) some.push_back(rays[i]);
  return some;
}

BorderBrightness first_brightness(const Rays& rays) {
  const ProfileGrid grid = BorderModel::border_grid();
  const Index from = grid.index_at(kMarrowFrom), up_to = grid.index_at(kMarrowUpTo) + 1,
              end = grid.index_at(kCortexUpTo) + 1;
  std::vector<double> marrow, darkest, variance;
  for (const BorderRay& ray : rays) {
    const auto inside = ray.profile.segment(from, up_to - from);
    marrow.push_back(inside.mean());
    variance.push_back((inside.array() - inside.mean()).square().mean());
    darkest.push_back(ray.profile.segment(up_to, end - up_to).minCoeff());
  }
  BorderBrightness b;
  b.marrow = quantile(marrow, 0.5);
  b.cortex = quantile(darkest, kDarkShare);
  b.dark = b.cortex + kDarkAbove * (b.marrow - b.cortex);
  b.noise = std::hypot(std::sqrt(quantile(variance, 0.5)), kModelError * (b.marrow - b.cortex));
  return b;
}

void update_fits_of(Rays& rays, const BorderLook& look) {
  BorderModels models;
  if (rays.empty()) return;
  models.add(rays, rays.front().image, look);
  parallel_for(static_cast<std::int64_t>(rays.size()), [&](Index i) {
    BorderRay& ray = rays[static_cast<std::size_t>(i)];
    ray.fit = models.fit(ray);
  });
}

double mean_misfit(const Rays& rays) {
  double sum = 0.0;
  for (const BorderRay& ray : rays) sum += ray.fit.misfit;
  return std::max(sum / static_cast<double>(rays.size()), kLeastMisfit);
}

/// The look that leaves least of an image's clear rays unexplained; none where it does not show
/// bones as bright marrow in dark cortex.
std::optional<BorderLook> likeliest_look(const Rays& rays) {
  BorderLook look{first_brightness(rays), 1.0};
  if (!(look.brightness.cortex < kDarkest * look.brightness.marrow)) return std::nullopt;
  Rays some = every_nth(rays, 4 * kEnough);
  update_fits_of(some, look);
  std::erase_if(some, [&](const BorderRay& ray) {
    return ray.fit.band < kClearBand || ray.fit.outer_deviation > kClearDeviation ||
           ray.fit.outside < kClearOutside * look.brightness.marrow;
  });
  if (some.size() < kFewest) return std::nullopt;
  some = every_nth(some, kEnough);
  // noise is what such rays leave unexplained
  look.brightness.noise *= std::sqrt(mean_misfit(some));
  const double darkest = look.brightness.cortex;
  double least = kInfinity;
  BorderLook best = look;
  for (const double cortex : kCortexShare) {
    for (const double blur : kBlurShare) {
      BorderLook trial = look;
      trial.brightness.cortex = cortex * darkest;
      trial.blur_share = blur;
      update_fits_of(some, trial);
      double cost = 0.0;
      for (const BorderRay& ray : some) cost += ray.fit.cost;
      if (cost >= least) continue;
      least = cost;
      best = trial;
    }
  }
  update_fits_of(some, best);
  best.brightness.noise *= std::sqrt(mean_misfit(some));
  return best;
}

}  // namespace

std::vector<BorderRay> border_rays(const TriMesh& bone, std::span<const PreparedImage> images) {
  const Points normals = vertex_normals(bone);
  Rays found(static_cast<std::size_t>(bone.n_vertices()));
  parallel_for(bone.n_vertices(), [&](Index v) {
    BorderRay& ray = found[static_cast<std::size_t>(v)];
    ray.vertex = v;
    const Vec3 place = bone.points.row(v), normal = normals.row(v);
    for (std::size_t i = 0; i < images.size(); ++i) {
      const double half = blur_along(images[i].volume, normal);
      if (ray.profile.size() > 0 && ray.half_voxel <= half) continue;
      auto values = profile_along(images[i].volume, place, normal, BorderModel::border_grid());
      if (!values) continue;
      ray.profile = std::move(*values);
      ray.half_voxel = half;
      ray.image = i;
    }
  });
  std::erase_if(found, [](const BorderRay& ray) { return ray.profile.size() == 0; });
  return found;
}

std::pair<std::size_t, long> BorderModels::key(const BorderRay& ray) const {
  const double blur = share_.at(ray.image) * ray.half_voxel;
  return {ray.image, std::max(1L, std::lround(blur / kBlurStep))};
}

void BorderModels::add(const Rays& rays, std::size_t image, const BorderLook& look) {
  share_[image] = look.blur_share;
  for (const BorderRay& ray : rays) {
    if (ray.image != image || models_.contains(key(ray))) continue;
    const double blur = static_cast<double>(key(ray).second) * kBlurStep;
    models_.emplace(key(ray), BorderModel(look.brightness, blur));
  }
}

BorderFit BorderModels::fit(const BorderRay& ray, const BandPrior& prior) const {
  return models_.at(key(ray)).fit(ray.profile, prior);
}

BorderModels fitted_models(std::vector<Rays>& rays, std::size_t n_images) {
  BorderModels models;
  for (std::size_t image = 0; image < n_images; ++image) {
    const Rays own = of_image(rays, image);
    if (own.size() < kFewest) continue;
    if (const auto look = likeliest_look(own)) models.add(own, image, *look);
  }
  for (Rays& bone : rays) {
    std::erase_if(bone, [&](const BorderRay& ray) { return !models.has(ray.image); });
    parallel_for(static_cast<std::int64_t>(bone.size()), [&](Index i) {
      BorderRay& ray = bone[static_cast<std::size_t>(i)];
      ray.fit = models.fit(ray);
    });
  }
  return models;
}

}  // namespace coxa::segment
