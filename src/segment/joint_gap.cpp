#include <coxa/segment/joint_gap.h>

#include <coxa/core/parallel.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "blurred_edge.h"
#include "coverage_rays.h"

namespace coxa::segment {
namespace {

// samples, mm apart, from so far inside one cortex to so far inside the other
constexpr double kStep = 0.2, kIntoCortex = 0.6;
// places tried, mm apart, not nearer than this to either border
constexpr double kPlaceStep = 0.1, kOfRoom = 0.25, kLeastRoom = 1.2;
// fluid is brighter than cartilage by this share of what that is brighter than cortex: about twice
// as bright in a gradient echo. Lines are not wider than the second, mm
constexpr double kFluid = 1.0, kWidest = 0.5;
constexpr std::size_t kFewest = 50;
// model without noise, share of the brightness
constexpr double kModelError = 0.03;

/// What is left of a ray's profile when everything but a line is explained, and what is left of
/// each line.
struct Explained {
  VecX strength;      ///< by place tried, of the line, brightness times mm
  VecX gain;          ///< by place: how much of the squared residual it takes
  double left = 0.0;  ///< squared residual per sample without a line
  double bright = 0.0, samples = 0.0;
  double half_voxel = 0.0, room = 0.0;
  std::size_t image = 0;
  bool known = false;
};

double place_at(double room, Index i) { return kOfRoom * room + kPlaceStep * i; }

double bell(double s, double at, double blur) {
  const double t = (s - at) / blur;
  return std::exp(-0.5 * t * t) / (blur * std::sqrt(2.0 * kPi));
}

VecX line_at(const VecX& s, double at, double blur) {
  return s.unaryExpr([&](double x) { return bell(x, at, blur); });
}

/// One bright layer, uneven, whose edges may be a little off, between dark cortices.
MatX layer_basis(const VecX& s, double room, double blur) {
  MatX basis(s.size(), 5);
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const double inside = past(s[i], 0.0, blur) - past(s[i], room, blur);
    basis.row(i) << 1.0, inside, inside * (s[i] / room - 0.5), bell(s[i], 0.0, blur),
        bell(s[i], room, blur);
  }
  return basis;
}

Explained explained(const GapRay& ray, std::span<const PreparedImage> images,
                    std::span<const double> blurs) {
  Explained e;
  const ProfileGrid grid{-kIntoCortex, kStep,
                         static_cast<Index>((ray.room + 2.0 * kIntoCortex) / kStep) + 1};
  e.room = ray.room;
  VecX profile;
  double blur = kInfinity;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const double half = blur_along(images[i].volume, ray.direction);
    if (blurs[i] * half >= blur) continue;
    auto values = profile_along(images[i].volume, ray.place, ray.direction, grid);
    if (!values) continue;
    profile = std::move(*values);
    blur = blurs[i] * half;
    e.half_voxel = half;
    e.image = i;
  }
  const auto n = static_cast<Index>((1.0 - 2.0 * kOfRoom) * ray.room / kPlaceStep) + 1;
  if (profile.size() == 0 || ray.room < kLeastRoom) return e;
  const VecX s = VecX::LinSpaced(grid.n, grid.first, grid.at(grid.n - 1));
  const MatX basis = layer_basis(s, ray.room, blur);
  const Eigen::ColPivHouseholderQR<MatX> qr(basis);
  const VecX unknowns = qr.solve(profile), rest = profile - basis * unknowns;
  e.bright = unknowns[1];
  e.samples = static_cast<double>(s.size());
  e.left = rest.squaredNorm() / e.samples;
  e.strength = VecX::Zero(n);
  e.gain = VecX::Zero(n);
  for (Index k = 0; k < n; ++k) {
    VecX line = line_at(s, place_at(ray.room, k), blur);
    line -= basis * qr.solve(line);
    const double size = line.squaredNorm();
    if (size < 1e-9) continue;
    e.strength[k] = line.dot(rest) / size;
    e.gain[k] = e.strength[k] * e.strength[k] * size;
  }
  e.known = e.bright > 0.0;
  return e;
}

/// Whether the line is bright (1) or dark (-1) in one image: as most rays have it, by weight.
double sign_of(const std::vector<Explained>& all, std::size_t image) {
  double sum = 0.0;
  for (const Explained& e : all) {
    if (!e.known || e.image != image) continue;
    Eigen::Index best = 0;
    const double gain = e.gain.maxCoeff(&best);
    sum += std::copysign(gain / (e.bright * e.bright), e.strength[best]);
  }
  return sum < 0.0 ? -1.0 : 1.0;
}

/// Median over an image's rays of what the likeliest line of that sign leaves, per sample.
double noise_of(const std::vector<Explained>& all, std::size_t image, double sign) {
  std::vector<double> left, bright;
  for (const Explained& e : all) {
    if (!e.known || e.image != image) continue;
    double gain = 0.0;
    for (Eigen::Index k = 0; k < e.gain.size(); ++k)
      if (sign * e.strength[k] > 0.0) gain = std::max(gain, e.gain[k]);
    left.push_back(e.left - gain / e.samples);
    bright.push_back(e.bright);
  }
  if (left.size() < kFewest) return kInfinity;
  const double model = kModelError * quantile(bright, 0.5);
  return quantile(left, 0.5) + model * model;
}

GapFit fit_of(const Explained& e, double sign, double noise) {
  GapFit fit{0.0, kInfinity, 0.0};
  if (!e.known || sign < 0.0 || !(noise < kInfinity)) return fit;
  // samples nearer than a voxel tell the same
  const double independent = std::min(1.0, kStep / (2.0 * e.half_voxel));
  double best = -1.0, total = 0.0;
  VecX likelihood(e.gain.size());
  for (Eigen::Index k = 0; k < e.gain.size(); ++k) {
    const double gain = sign * e.strength[k] > 0.0 ? e.gain[k] : 0.0;
    likelihood[k] = 0.5 * independent * gain / noise;
    if (likelihood[k] <= best) continue;
    best = likelihood[k];
    fit.middle = place_at(e.room, static_cast<Index>(k));
    fit.width = std::clamp(e.strength[k] / (kFluid * e.bright), 0.0, kWidest);
  }
  likelihood = (likelihood.array() - best).exp();
  double squares = 0.0;
  for (Eigen::Index k = 0; k < likelihood.size(); ++k) {
    total += likelihood[k];
    squares += likelihood[k] * std::pow(place_at(e.room, static_cast<Index>(k)) - fit.middle, 2);
  }
  fit.deviation = std::sqrt(squares / total);
  return fit;
}

}  // namespace

std::vector<GapFit> gaps_between(std::span<const GapRay> rays,
                                 std::span<const PreparedImage> images,
                                 std::span<const double> blur) {
  std::vector<Explained> all(rays.size());
  parallel_for(static_cast<std::int64_t>(rays.size()), [&](Index i) {
    const auto k = static_cast<std::size_t>(i);
    all[k] = explained(rays[k], images, blur);
  });
  std::vector<double> sign, noise;
  for (std::size_t image = 0; image < images.size(); ++image) {
    sign.push_back(sign_of(all, image));
    noise.push_back(noise_of(all, image, sign.back()));
  }
  std::vector<GapFit> fits(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    fits[i] = fit_of(all[i], sign[all[i].image], noise[all[i].image]);
  return fits;
}

}  // namespace coxa::segment
