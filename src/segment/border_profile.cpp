#include <coxa/segment/border_profile.h>

#include <coxa/core/error.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "blurred_edge.h"

namespace coxa::segment {
namespace {

// places and widths tried, mm
constexpr double kFarthest = 2.5, kStep = 0.25;
constexpr double kThinnest = 0.4, kThickest = 5.0, kBandStep = 0.2;
// the likeliest is refined down to this, mm
constexpr double kFine = 0.005;
// how far inside and outside the dark band a hypothesis has something to say, mm
constexpr double kInside = 1.25, kOutside = 1.0;
// relative standard deviations of what is known of the brightnesses: nothing outside
constexpr double kMarrowSpread = 0.12, kOutsideSpread = 3.0;
// cost of something as dark as cortex outside: that belongs to the band
constexpr double kDark = 60.0;
// cost of something dark on the cortex
constexpr double kSheath = 9.0;
// a sample's squared residual, in units of noise, counts at most this much
constexpr double kLargestResidual = 9.0;

constexpr Index kMostSamples = 64;
using Samples = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostSamples, 1>;

}  // namespace

BorderModel::BorderModel(const BorderBrightness& brightness, double blur, const ProfileGrid& grid)
    : brightness_(brightness), blur_(blur), grid_(grid) {
  require(blur > 0.0, "the blur of a profile must be positive, got ", blur, " mm");
  require(brightness.noise > 0.0, "the noise of a profile must be positive, got ",
          brightness.noise);
  require(grid.n >= 2 && grid.n <= kMostSamples, "a profile has 2 to ", kMostSamples,
          " samples, got ", grid.n);
  const Vec2 deviation(std::max(kMarrowSpread * std::abs(brightness.marrow), brightness.noise),
                       std::max(kOutsideSpread * std::abs(brightness.marrow), brightness.noise));
  prior_ = Vec2::Constant(brightness.marrow);
  weight_ = deviation.cwiseAbs2().cwiseInverse();
  const int n = static_cast<int>(std::lround(kFarthest / kStep));
  const int n_bands = static_cast<int>(std::lround((kThickest - kThinnest) / kBandStep));
  for (int b = -n; b <= n; ++b) {
    for (int k = 0; k <= n_bands; ++k) {
      const double outer = b * kStep, band = kThinnest + k * kBandStep;
      hypotheses_.push_back(make(outer, band, window_of(outer, band)));
    }
  }
}

BorderModel::Window BorderModel::window_of(double outer, double band) const {
  const auto sample_at = [&](double s) { return (s - grid_.first) / grid_.step; };
  const double from = std::ceil(sample_at(outer - band - kInside)),
               to = std::floor(sample_at(outer + kOutside)) + 1.0;
  const Index begin = std::clamp<Index>(static_cast<Index>(from), 0, grid_.n);
  return {begin, std::clamp<Index>(static_cast<Index>(to), begin, grid_.n)};
}

BorderModel::Hypothesis BorderModel::make(double outer, double band, Window window) const {
  const double inner = outer - band;
  Hypothesis h;
  h.outer = outer;
  h.band = band;
  h.window = window;
  const Index n = window.end - window.begin;
  h.fixed.resize(n);
  h.basis.resize(n, 2);
  for (Index i = 0; i < n; ++i) {
    const double s = grid_.at(window.begin + i);
    const double in_band = past(s, inner, blur_), out = past(s, outer, blur_);
    h.fixed[i] = brightness_.cortex * (in_band - out);
    h.basis(i, 0) = 1.0 - in_band;
    h.basis(i, 1) = out;
  }
  const MatX scaled = h.basis / (brightness_.noise * brightness_.noise);
  Eigen::Matrix2d normal = h.basis.transpose() * scaled;
  normal.diagonal() += weight_;
  const Eigen::Matrix2d inverse = normal.inverse();
  h.gain = inverse * scaled.transpose();
  h.start = inverse * weight_.cwiseProduct(prior_);
  return h;
}

BorderModel::Outcome BorderModel::try_on(const Hypothesis& h, const VecX& profile,
                                         const BandPrior& band) const {
  const Index n = h.window.end - h.window.begin;
  const Samples y = profile.segment(h.window.begin, n) - h.fixed;
  const Vec2 brightness = h.gain * y + h.start;
  const Samples residual = (y - h.basis * brightness) / brightness_.noise;
  const double explained = residual.cwiseAbs2().cwiseMin(kLargestResidual).sum();
  const double off = (h.band - band.width) / band.deviation;
  // samples that a hypothesis says nothing of count as one of noise
  const double cost = explained + (off > 0.0 ? std::min(off * off, kSheath) : off * off) +
                      static_cast<double>(grid_.n - n) +
                      (brightness - prior_).cwiseAbs2().dot(weight_) +
                      kDark * past(-brightness[1], -brightness_.dark, brightness_.noise);
  return {cost, brightness[1], explained / static_cast<double>(n)};
}

BorderModel::Hypothesis BorderModel::refined(Hypothesis best, const VecX& profile,
                                             const BandPrior& band) const {
  double least = try_on(best, profile, band).cost;
  for (double step = 0.5 * kBandStep; step > kFine; step *= 0.5) {
    // both borders one after the other, each as long as it helps
    for (bool better = true; better;) {
      better = false;
      for (const auto& [outwards, wider] : {std::pair(step, step), std::pair(-step, -step),
                                            std::pair(0.0, step), std::pair(0.0, -step)}) {
        if (best.band + wider < 0.5 * kThinnest) continue;
        Hypothesis other = make(best.outer + outwards, best.band + wider, best.window);
        const double cost = try_on(other, profile, band).cost;
        if (cost >= least) continue;
        least = cost;
        best = std::move(other);
        better = true;
      }
    }
  }
  return best;
}

BorderFit BorderModel::fit(const VecX& profile, const BandPrior& prior) const {
  std::vector<double> costs;
  costs.reserve(hypotheses_.size());
  for (const Hypothesis& h : hypotheses_) costs.push_back(try_on(h, profile, prior).cost);
  const auto likeliest = std::min_element(costs.begin(), costs.end());
  const Hypothesis best =
      refined(hypotheses_[static_cast<std::size_t>(likeliest - costs.begin())], profile, prior);
  const Outcome outcome = try_on(best, profile, prior);
  // samples nearer to each other than two blurs tell the same
  const double independent = std::min(1.0, grid_.step / (2.0 * blur_));
  double total = 0.0, inner = 0.0, outer = 0.0, band = 0.0;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const Hypothesis& h = hypotheses_[i];
    const double weight = std::exp(-0.5 * independent * (costs[i] - *likeliest));
    total += weight;
    outer += weight * std::pow(h.outer - best.outer, 2);
    band += weight * std::pow(h.band - best.band, 2);
    inner += weight * std::pow(h.outer - h.band - best.outer + best.band, 2);
  }
  BorderFit fit;
  fit.inner = best.outer - best.band;
  fit.outer = best.outer;
  fit.band = best.band;
  fit.inner_deviation = std::sqrt(inner / total);
  fit.outer_deviation = std::sqrt(outer / total);
  fit.band_deviation = std::sqrt(band / total);
  fit.outside = outcome.outside;
  fit.cost = outcome.cost;
  fit.misfit = outcome.misfit;
  return fit;
}

}  // namespace coxa::segment
