#include "profile_correlation.h"

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// Share of a profile's weight that must lie in the image.
constexpr double kSeenShare = 0.75;
/// Weighted variance below which what is left of a reference in the image has no shape.
constexpr double kLeastVariance = 1e-12;

/// Correlation with samples [first, first + n), some of them outside the image.
double partial_correlation(const ProfileReference& r, const VecX& samples, Index first,
                           double flat) {
  const Index n = static_cast<Index>(r.value.size());
  double weight = 0.0, mean = 0.0, reference_mean = 0.0;
  for (Index k = 0; k < n; ++k) {
    const double I = samples[first + k];
    if (std::isnan(I)) continue;
    weight += r.weight[k];
    mean += r.weight[k] * I;
    reference_mean += r.weight[k] * r.value[k];
  }
  if (weight < kSeenShare) return kNaN;
  mean /= weight;
  reference_mean /= weight;
  double cross = 0.0, variance = 0.0, reference_variance = 0.0;
  for (Index k = 0; k < n; ++k) {
    const double I = samples[first + k];
    if (std::isnan(I)) continue;
    const double a = I - mean, b = r.value[k] - reference_mean;
    cross += r.weight[k] * a * b;
    variance += r.weight[k] * a * a;
    reference_variance += r.weight[k] * b * b;
  }
  if (reference_variance < kLeastVariance) return 0.0;
  return cross / std::sqrt((variance + weight * flat * flat) * reference_variance);
}

/// All shifts side by side: the same sums in the same order as one after the other.
VecX whole_correlations(const ProfileReference& r, const VecX& line, double flat) {
  const Eigen::Index n = r.value.size(), shifts = line.size() - n + 1;
  double weight = 0.0, reference_mean = 0.0;
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(shifts), cross = mean, variance = mean;
  for (Eigen::Index k = 0; k < n; ++k) {
    weight += r.weight[k];
    mean += r.weight[k] * line.segment(k, shifts).array();
    reference_mean += r.weight[k] * r.value[k];
  }
  mean /= weight;
  reference_mean /= weight;
  double reference_variance = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double b = r.value[k] - reference_mean;
    const auto a = line.segment(k, shifts).array() - mean;
    cross += r.weight[k] * a * b;
    variance += r.weight[k] * a * a;
    reference_variance += r.weight[k] * b * b;
  }
  if (reference_variance < kLeastVariance) return VecX::Zero(shifts);
  return cross / ((variance + weight * flat * flat) * reference_variance).sqrt();
}

}  // namespace

ProfileReference make_reference(const VecX& profile, Index n_inside, double step, double window) {
  ProfileReference r;
  const Index n = static_cast<Index>(profile.size());
  r.weight.resize(n);
  for (Index k = 0; k < n; ++k) {
    const double t = (k - n_inside) * step / window;
    r.weight[k] = std::exp(-0.5 * t * t);
  }
  r.weight /= r.weight.sum();
  r.value = profile.array() - r.weight.dot(profile);
  const double variance = r.weight.dot(r.value.cwiseAbs2());
  const double extent = profile.maxCoeff() - profile.minCoeff();
  r.informative = variance > kLeastVariance;
  if (!r.informative) return r;
  r.value /= std::sqrt(variance);
  const Index before = std::max<Index>(0, n_inside - 1), after = std::min(n - 1, n_inside + 1);
  r.slope = std::clamp((profile[after] - profile[before]) / extent, -1.0, 1.0);
  return r;
}

VecX correlations(const ProfileReference& reference, const VecX& line, double flat) {
  if (!line.hasNaN()) return whole_correlations(reference, line, flat);
  VecX result(line.size() - reference.value.size() + 1);
  for (Eigen::Index s = 0; s < result.size(); ++s)
    result[s] = partial_correlation(reference, line, static_cast<Index>(s), flat);
  return result;
}

}  // namespace coxa::segment
