#pragma once

#include "feature_curves.h"
#include "slide_guide.h"

#include <coxa/geom/triangle_tree.h>

#include <utility>

namespace coxa::meshing {

/// Guide of a solid: boundary nodes slide on its whole surface, those of a crease along its feature
/// curves.
class SolidGuide : public SlideGuide {
 public:
  /// @param surface  must outlive the guide
  explicit SolidGuide(const TriangleTree& surface, FeatureCurves features = {})
      : surface_(surface), features_(std::move(features)) {}
  const FeatureCurves& features() const { return features_; }
  Vec3 place(NodeKind kind, const Vec3& p) const override;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind kind,
                                                               const Vec3& p) const override;

 private:
  const TriangleTree& surface_;
  FeatureCurves features_;
};

}  // namespace coxa::meshing
