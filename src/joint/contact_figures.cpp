#include <coxa/core/parallel.h>

#include <Eigen/Geometry>
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

std::vector<collide::ContactSample> samples_in_contact(
    const HipSystem& system, const HipState& state, std::vector<collide::ContactSample> samples) {
  const collide::SurfaceContact& contact = state.contact.cartilages();
  VecX overlap = VecX::Zero(contact.slave().n_vertices());
  for (const collide::ContactConstraint& constraint : contact.constraints()) {
    const double p = contact.pressure(constraint, state.x);
    overlap[constraint.owner] =
        p > 0.0 ? p / system.foundation_stiffness() : -contact.gap(constraint, state.x);
  }
  std::erase_if(samples, [&](const collide::ContactSample& sample) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += sample.barycentric[k] * overlap[contact.slave().triangles(sample.triangle, k)];
    }
    return !(sample.pressure > 0.0 && sum > 0.0);
  });
  return samples;
}

double weighted_percentile(std::vector<std::pair<double, double>> values, double share) {
  std::stable_sort(values.begin(), values.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  double total = 0.0, below = 0.0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values) {
    below += weight;
    if (below >= share * total) return value;
  }
  return values.empty() ? 0.0 : values.back().first;
}

double pressure_percentile(const std::vector<collide::ContactSample>& samples, double share) {
  std::vector<std::pair<double, double>> pressures;
  for (const auto& sample : samples) pressures.emplace_back(sample.pressure, sample.area);
  return weighted_percentile(std::move(pressures), share);
}

ThinFigures thin_figures(const std::vector<collide::ContactSample>& touching,
                         const collide::SurfaceContact& contact, const VecX& thickness) {
  ThinFigures thin;
  std::vector<collide::ContactSample> thick;
  for (const collide::ContactSample& sample : touching) {
    double here = 0.0;
    for (int k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(contact.slave().triangles(sample.triangle, k));
      here += sample.barycentric[k] * thickness[contact.slave().particle[vertex]];
    }
    if (here < kThinCartilage)
      thin.force += sample.pressure * sample.area;
    else
      thick.push_back(sample);
  }
  thin.peak_pressure_p99 = pressure_percentile(thick, 0.99);
  return thin;
}

double patch_peak(const std::vector<collide::ContactSample>& samples, double area) {
  const double radius = std::sqrt(area / kPi);
  double largest = 0.0;
  for (const auto& sample : samples) largest = std::max(largest, sample.pressure);
  const auto is_high = [&](const collide::ContactSample& sample) {
    return sample.pressure > 0.0 && sample.pressure >= kHigh * largest;
  };
  Eigen::AlignedBox3d within;  // of all that the discs can cover
  for (const auto& sample : samples) {
    if (is_high(sample)) within.extend(sample.point);
  }
  within = {within.min().array() - radius, within.max().array() + radius};

  // samples by cells as wide as the disc's radius, so that 27 cells hold all that a disc can
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](const Vec3& point) {
    return Cell{std::llround(point[0] / radius), std::llround(point[1] / radius),
                std::llround(point[2] / radius)};
  };
  std::vector<std::pair<Cell, std::size_t>> order;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (within.contains(samples[s].point)) order.emplace_back(cell_of(samples[s].point), s);
  }
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
  return parallel_reduce(
      static_cast<std::int64_t>(samples.size()), 0.0,
      [&](Index s) {
        const auto& sample = samples[static_cast<std::size_t>(s)];
        return is_high(sample) ? mean_around(sample.point) : 0.0;
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace coxa::joint
