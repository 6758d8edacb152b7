#pragma once

#include <coxa/image/volume.h>

#include <cmath>
#include <optional>
#include <vector>

namespace coxa::segment {

/// Brightness of the tissues about a joint's bone, in the units of one image.
struct TissueBrightness {
  double marrow = 0.0, cortex = 0.0, cartilage = 0.0;
  double cartilage_deviation = 0.0;  ///< standard deviation of what is known of the cartilage's
  double noise = 1.0;                ///< standard deviation of a sample from the layered model, > 0
};

/// Where a profile is sampled: from `first` mm (negative: inside the bone) in steps, outwards.
struct ProfileGrid {
  double first = -4.0, step = 0.25;  ///< mm
  Index n = 45;
  double at(Index i) const { return first + step * i; }
  Index index_at(double s) const { return static_cast<Index>(std::lround((s - first) / step)); }
};

/// Values along a unit normal at p; none where the profile leaves the image.
std::optional<VecX> profile_along(const Volume& volume, const Vec3& p, const Vec3& normal,
                                  const ProfileGrid& grid);

/// What a profile says about the layers at a bone's border.
struct LayerFit {
  /// How much better (half the difference of squared residuals in units of noise) a layer of
  /// cartilage explains the profile than bare bone does.
  double evidence = 0.0;
  double bone = 0.0;       ///< mm, place of the bone's border under the cartilage
  double thickness = 0.0;  ///< mm, of the cartilage, if there is any
  double cartilage = 0.0;  ///< its brightness
  double beyond = 0.0;     ///< that of what lies on it
  double cost = 0.0;       ///< of the cartilage: squared residuals in units of noise, and priors
};

/// Profiles of tissue in layers, blurred: marrow, cortex, then cartilage of some thickness and
/// whatever lies beyond, or no cartilage but a thin dark sheath and what lies beyond.
///
/// Edges are cumulative Gaussians; places and thicknesses are tried on a grid, brightnesses are
/// linear unknowns with priors, residuals are bounded, so that what the model does not know costs
/// little. Beside a bright tissue the border of a thin dark layer lies elsewhere than the
/// steepest slope: only a model of the blur finds it.
/// Source: layers under a Gaussian blur, Treece et al. 2010 (cortex in CT); hypotheses ours
class LayerModel {
 public:
  /// @param blur mm, standard deviation along the normal, > 0   @param grid of 2 to 64 samples
  LayerModel(const TissueBrightness& brightness, double blur, const ProfileGrid& grid = {});

  /// @param profile values on the grid, finite
  LayerFit fit(const VecX& profile) const;

 private:
  struct Hypothesis {
    double bone = 0.0, thickness = 0.0;
    bool covered = false;
    Index begin = 0, end = 0;  ///< samples it explains
    VecX fixed;                ///< known part of the profile there
    MatX basis;                ///< samples × unknown brightnesses
    MatX gain;                 ///< unknowns × samples: of the profile less what is fixed
    VecX start;                ///< unknowns where that is 0
    VecX prior, weight;        ///< of the unknowns: mean, 1 / variance
  };
  struct Outcome {
    double cost = kInfinity;
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> brightness;
  };
  Hypothesis make(double bone, double cortex, double thickness, bool covered, double blur) const;
  Outcome try_on(const Hypothesis& hypothesis, const VecX& profile) const;
  /// Of bare bone beside something as bright as cartilage.
  double penalty_of_outside(double outside) const;
  /// In [0, 1]: whether the brightness inside is the marrow's. Elsewhere the bone's border is
  /// wrong, and cartilage beyond it is another bone's.
  double likeness_to_bone(const VecX& profile) const;

  TissueBrightness brightness_;
  ProfileGrid grid_;
  std::vector<Hypothesis> hypotheses_;
};

}  // namespace coxa::segment
