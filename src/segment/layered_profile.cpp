#include <coxa/segment/layered_profile.h>

#include <coxa/core/error.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "blurred_edge.h"

namespace coxa::segment {
namespace {

// places and thicknesses tried, mm
constexpr double kFarthestBone = 1.75, kBoneStep = 0.25;
constexpr double kCortex[] = {0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0};
constexpr double kThinnest = 0.6, kThickest = 5.6, kThicknessStep = 0.2;
constexpr double kSheath[] = {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0};
// how far inside the cortex and beyond the last layer a hypothesis has something to say, mm
constexpr double kInside = 1.25, kBeyond = 1.0, kBeyondSheath = 1.5;
// relative standard deviations of what is known of the brightnesses
constexpr double kMarrowSpread = 0.1, kSheathSpread = 0.15, kBeyondSpread = 3.0;
// a sheath is as dark as cortex, or this much of the way to a brighter cartilage
constexpr double kSheathShare = 0.25;
// a sample's squared residual, in units of noise, counts at most this much; one outside the
// hypothesis counts as one of noise
constexpr double kLargestResidual = 9.0;
// samples up to here, mm, tell whether this is bone at all: how far (relative) their mean may be
// from the marrow's, and the evidence against a layer where it is not
constexpr double kMarrowUpTo = -2.5, kForeignSpread = 0.2, kForeign = 5.0;
// bare bone next to something as bright as cartilage would be a chance: cost, and how near is near
// (share of the contrast of cartilage and cortex)
constexpr double kLikeCartilage = 12.0, kNearness = 0.3;
// cartilage brighter than marrow is the brightest tissue: so bright are only it and fluid on it
constexpr double kBrightShare = 0.6, kBrightWidth = 0.05;

constexpr Index kMostSamples = 64;
using Samples = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostSamples, 1>;

}  // namespace

std::optional<VecX> profile_along(const Volume& volume, const Vec3& p, const Vec3& normal,
                                  const ProfileGrid& grid) {
  VecX values(grid.n);
  for (Index i = 0; i < grid.n; ++i) {
    values[i] = sample(volume, p + grid.at(i) * normal);
    if (!std::isfinite(values[i])) return std::nullopt;
  }
  return values;
}

LayerModel::LayerModel(const TissueBrightness& brightness, double blur, const ProfileGrid& grid)
    : brightness_(brightness), grid_(grid) {
  require(blur > 0.0, "the blur of a profile must be positive, got ", blur, " mm");
  require(brightness.noise > 0.0, "the noise of a profile must be positive, got ",
          brightness.noise);
  require(grid.n >= 2 && grid.n <= kMostSamples, "a profile has 2 to ", kMostSamples,
          " samples, got ", grid.n);
  const int n_bone = static_cast<int>(std::lround(kFarthestBone / kBoneStep));
  const int n_thick = static_cast<int>(std::lround((kThickest - kThinnest) / kThicknessStep));
  for (int b = -n_bone; b <= n_bone; ++b) {
    for (const double cortex : kCortex) {
      for (int t = 0; t <= n_thick; ++t)
        hypotheses_.push_back(
            make(b * kBoneStep, cortex, kThinnest + t * kThicknessStep, true, blur));
      for (const double sheath : kSheath)
        hypotheses_.push_back(make(b * kBoneStep, cortex, sheath, false, blur));
    }
  }
}

LayerModel::Hypothesis LayerModel::make(double bone, double cortex, double thickness, bool covered,
                                        double blur) const {
  const TissueBrightness& b = brightness_;
  Hypothesis h;
  h.bone = bone;
  h.thickness = thickness;
  h.covered = covered;
  const double from = bone - cortex - kInside;
  const double to = bone + thickness + (covered ? kBeyond : kBeyondSheath);
  h.begin = std::clamp<Index>(static_cast<Index>(std::ceil((from - grid_.first) / grid_.step)), 0,
                              grid_.n);
  h.end = std::clamp<Index>(static_cast<Index>(std::floor((to - grid_.first) / grid_.step)) + 1,
                            h.begin, grid_.n);
  const Index n = h.end - h.begin;
  const bool layer = covered || thickness > 0.0;
  const Index n_unknown = layer ? 3 : 2;
  h.fixed.resize(n);
  h.basis.resize(n, n_unknown);
  for (Index i = 0; i < n; ++i) {
    const double s = grid_.at(h.begin + i);
    const double in_cortex = past(s, bone - cortex, blur), out = past(s, bone, blur);
    const double beyond = layer ? past(s, bone + thickness, blur) : out;
    h.fixed[i] = b.cortex * (in_cortex - out);
    h.basis(i, 0) = 1.0 - in_cortex;
    if (layer) h.basis(i, 1) = out - beyond;
    h.basis(i, n_unknown - 1) = beyond;
  }
  const double widest = kBeyondSpread * (std::abs(b.cartilage) + std::abs(b.marrow));
  const double contrast = b.cartilage - b.cortex;
  h.prior = VecX::Constant(n_unknown, covered ? b.cortex : b.marrow);
  VecX deviation = VecX::Constant(n_unknown, widest);
  h.prior[0] = b.marrow;
  deviation[0] = std::max(kMarrowSpread * std::abs(b.marrow), b.noise);
  if (layer) {
    h.prior[1] = covered ? b.cartilage : b.cortex + kSheathShare * std::max(contrast, 0.0);
    deviation[1] = covered ? b.cartilage_deviation : kSheathSpread * std::abs(contrast);
  }
  h.weight = deviation.cwiseMax(1e-6 * b.noise).cwiseAbs2().cwiseInverse();
  const MatX scaled = h.basis / (b.noise * b.noise);
  MatX normal = h.basis.transpose() * scaled;
  normal.diagonal() += h.weight;
  const Eigen::LDLT<MatX> solver(normal);
  h.gain = solver.solve(scaled.transpose());
  h.start = solver.solve(h.weight.cwiseProduct(h.prior));
  return h;
}

double LayerModel::penalty_of_outside(double outside) const {
  const TissueBrightness& b = brightness_;
  if (b.cartilage > b.marrow)
    return kLikeCartilage * past(outside, kBrightShare * b.cartilage, kBrightWidth * b.cartilage);
  const double off = std::abs(outside - b.cartilage) /
                     (kNearness * std::max(std::abs(b.cartilage - b.cortex), b.noise));
  return kLikeCartilage * std::clamp(1.0 + kNearness - off, 0.0, 1.0);
}

double LayerModel::likeness_to_bone(const VecX& profile) const {
  const double spread = std::max(kForeignSpread * std::abs(brightness_.marrow), brightness_.noise);
  const Index n = std::clamp<Index>(grid_.index_at(kMarrowUpTo), 1, grid_.n);
  const double off = (profile.head(n).mean() - brightness_.marrow) / spread;
  return std::exp(-0.5 * off * off);
}

LayerModel::Outcome LayerModel::try_on(const Hypothesis& h, const VecX& profile) const {
  const Samples y = profile.segment(h.begin, h.end - h.begin) - h.fixed;
  Outcome outcome;
  outcome.brightness = h.gain * y + h.start;
  const Samples residual = (y - h.basis * outcome.brightness) / brightness_.noise;
  outcome.cost = residual.cwiseAbs2().cwiseMin(kLargestResidual).sum() +
                 static_cast<double>(grid_.n - (h.end - h.begin)) +
                 (outcome.brightness - h.prior).cwiseAbs2().dot(h.weight);
  return outcome;
}

LayerFit LayerModel::fit(const VecX& profile) const {
  Outcome bare, covered;
  LayerFit best;
  for (const Hypothesis& h : hypotheses_) {
    Outcome outcome = try_on(h, profile);
    if (!h.covered) outcome.cost += penalty_of_outside(outcome.brightness.tail<1>()[0]);
    Outcome& least = h.covered ? covered : bare;
    if (outcome.cost >= least.cost) continue;
    if (h.covered) {
      best.bone = h.bone;
      best.thickness = h.thickness;
      best.cartilage = outcome.brightness[1];
      best.beyond = outcome.brightness[2];
    }
    least = std::move(outcome);
  }
  best.cost = covered.cost;
  const double like_bone = likeness_to_bone(profile);
  best.evidence = like_bone * 0.5 * (bare.cost - covered.cost) - (1.0 - like_bone) * kForeign;
  return best;
}

}  // namespace coxa::segment
