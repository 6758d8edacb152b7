#include <coxa/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "frame_figures.h"

namespace coxa::joint {
namespace {

// discs are laid around samples of at least this share of the largest pressure
constexpr double kHigh = 0.5;

}  // namespace

std::vector<collide::ContactSample> samples_in_contact(const HipSystem& system,
                                                       const HipState& state) {
  const collide::SurfaceContact& contact = state.contact.cartilages();
  VecX overlap = VecX::Zero(contact.slave().n_vertices());
  for (const collide::ContactConstraint& constraint : contact.constraints()) {
    const double p = contact.pressure(constraint, state.x);
    overlap[constraint.owner] =
        p > 0.0 ? p / system.foundation_stiffness() : -contact.gap(constraint, state.x);
  }
  std::vector<collide::ContactSample> samples = contact.samples(state.x);
  std::erase_if(samples, [&](const collide::ContactSample& sample) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += sample.barycentric[k] * overlap[contact.slave().triangles(sample.triangle, k)];
    }
    return !(sample.pressure > 0.0 && sum > 0.0);
  });
  return samples;
}

double pressure_percentile(const std::vector<collide::ContactSample>& samples, double share) {
  std::vector<collide::ContactSample> sorted = samples;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.pressure < b.pressure; });
  double total = 0.0, below = 0.0;
  for (const auto& sample : sorted) total += sample.area;
  for (const auto& sample : sorted) {
    below += sample.area;
    if (below >= share * total) return sample.pressure;
  }
  return sorted.empty() ? 0.0 : sorted.back().pressure;
}

double patch_peak(const std::vector<collide::ContactSample>& samples, double area) {
  // samples by cells as wide as the disc's radius, so that 27 cells hold all that a disc can
  const double radius = std::sqrt(area / kPi);
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](const Vec3& point) {
    return Cell{std::llround(point[0] / radius), std::llround(point[1] / radius),
                std::llround(point[2] / radius)};
  };
  std::vector<std::pair<Cell, std::size_t>> order;
  for (std::size_t s = 0; s < samples.size(); ++s) order.emplace_back(cell_of(samples[s].point), s);
  std::sort(order.begin(), order.end());

  const auto mean_around = [&](const Vec3& centre) {
    double force = 0.0, covered = 0.0;
    const Cell middle = cell_of(centre);
    for (std::int64_t x = middle[0] - 1; x <= middle[0] + 1; ++x) {
      for (std::int64_t y = middle[1] - 1; y <= middle[1] + 1; ++y) {
        // cells along z stand side by side
        auto at = std::lower_bound(order.begin(), order.end(),
                                   std::pair{Cell{x, y, middle[2] - 1}, std::size_t{0}});
        for (; at != order.end() && at->first <= Cell{x, y, middle[2] + 1}; ++at) {
          const collide::ContactSample& sample = samples[at->second];
          if ((sample.point - centre).squaredNorm() > radius * radius) continue;
          force += sample.pressure * sample.area;
          covered += sample.area;
        }
      }
    }
    // where the surface ends within the disc, the rest of the patch carries nothing
    return force / std::max(covered, 0.75 * area);
  };
  double largest = 0.0;
  for (const auto& sample : samples) largest = std::max(largest, sample.pressure);
  return parallel_reduce(
      static_cast<std::int64_t>(samples.size()), 0.0,
      [&](Index s) {
        const auto& sample = samples[static_cast<std::size_t>(s)];
        const bool high = sample.pressure > 0.0 && sample.pressure >= kHigh * largest;
        return high ? mean_around(sample.point) : 0.0;
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace coxa::joint
