#pragma once

#include <coxa/segment/layered_profile.h>

#include <vector>

namespace coxa::segment {

/// Brightness of a bare bone's tissues, in the units of one image.
struct BorderBrightness {
  double marrow = 0.0, cortex = 0.0;
  double dark = 0.0;   ///< what is outside is brighter than this
  double noise = 1.0;  ///< standard deviation of a sample from the model, > 0
};

/// Where a profile's dark band lies, mm outwards: the likeliest, and the root of the mean square by
/// which everything tried, weighted by its likelihood, differs from it.
struct BorderFit {
  double inner = 0.0, inner_deviation = 0.0;  ///< border of marrow and cortex
  double outer = 0.0, outer_deviation = 0.0;  ///< border of the dark band and what lies outside
  double band = 0.0, band_deviation = 0.0;    ///< width of the dark band
  double outside = 0.0;                       ///< brightness beyond it, of the likeliest
  double cost = 0.0;    ///< of the likeliest: squared residuals in units of noise, and priors
  double misfit = 0.0;  ///< mean of the squared residuals of the samples explained, same units
};

/// What is known of the dark band's width beforehand, mm. A band much wider is a cortex of the
/// width known beneath something as dark, and not less likely the wider it is.
struct BandPrior {
  double width = 0.0, deviation = kInfinity;
};

/// Profiles across the border of a bone that nothing covers: marrow, a dark band of some width, and
/// whatever lies outside, blurred.
///
/// As in LayerModel edges are cumulative Gaussians, places are tried on a grid, brightnesses are
/// linear unknowns and residuals are bounded. The border of a thin dark band lies elsewhere than
/// the steepest slope, which the blur pushes outwards.
/// Source: Treece et al. 2010 (cortex in CT)
class BorderModel {
 public:
  /// @param blur mm, standard deviation along the normal, > 0   @param grid of 2 to 64 samples
  BorderModel(const BorderBrightness& brightness, double blur,
              const ProfileGrid& grid = border_grid());

  /// @param profile values on the grid, finite
  BorderFit fit(const VecX& profile, const BandPrior& prior = {}) const;

  /// Reaches as far inwards as the thickest cortex asks for.
  static ProfileGrid border_grid() { return {-8.5, 0.25, 53}; }

 private:
  /// Samples that are explained.
  struct Window {
    Index begin = 0, end = 0;
  };
  struct Hypothesis {
    double outer = 0.0, band = 0.0;
    Window window;
    VecX fixed;  ///< known part of the profile there
    MatX basis;  ///< samples × (marrow, outside)
    MatX gain;   ///< unknowns × samples: of the profile less what is fixed
    Vec2 start;  ///< unknowns where that is 0
  };
  struct Outcome {
    double cost = kInfinity;
    double outside = 0.0, misfit = 0.0;
  };
  Window window_of(double outer, double band) const;
  Hypothesis make(double outer, double band, Window window) const;
  /// The likeliest near the likeliest tried, over the same window.
  Hypothesis refined(Hypothesis best, const VecX& profile, const BandPrior& band) const;
  Outcome try_on(const Hypothesis& hypothesis, const VecX& profile, const BandPrior& band) const;

  BorderBrightness brightness_;
  double blur_;
  ProfileGrid grid_;
  Vec2 prior_, weight_;  ///< of marrow and outside: mean, 1 / variance
  std::vector<Hypothesis> hypotheses_;
};

}  // namespace coxa::segment
