#pragma once

#include <coxa/geom/fits.h>
#include <coxa/segment/profile_search.h>

#include <string>
#include <vector>

namespace coxa::segment {

/// Share of the vertices that must be in view for a place to count in full.
inline constexpr double kShareInView = 0.5;

/// How well the mean shapes of some bones fit an image at a pose: for trying many poses.
///
/// A few vertices of each bone are compared by the correlation of their mean profile with the
/// image, both smoothed alike. The image is sampled once for all contrasts.
class PoseScore {
 public:
  /// @param image            smoothed; must outlive this
  /// @param intensity_range  of the image
  /// @param smoothing        mm, of the image: the references are smoothed alike
  /// @param n_probes         vertices per bone
  PoseScore(const std::vector<const shape::StructureModel*>& bones, const Volume& image,
            double intensity_range, double smoothing, Index n_probes);

  const std::vector<std::string>& contrasts() const { return contrasts_; }
  /// Reliability-weighted mean correlation by contrast, in [-1, 1]; places mostly out of view count
  /// less.
  VecX at(const Similarity& pose) const;

 private:
  const Volume& image_;
  double flat_variance_ = 0.0;
  std::vector<std::string> contrasts_;
  Points points_, normals_;          // of all bones' probes
  VecX offsets_, weights_;           // along the normal, mm; of the samples, sum 1
  std::vector<MatX> references_;     // by contrast: probes × samples, weighted mean 0, variance 1
  std::vector<VecX> reliabilities_;  // by contrast
};

}  // namespace coxa::segment
