#pragma once

#include "slide_guide.h"

#include <coxa/geom/triangle_tree.h>

namespace coxa::meshing {

/// Guide of a solid: boundary nodes slide on its whole surface.
class SolidGuide : public SlideGuide {
 public:
  /// @param surface  must outlive the guide
  explicit SolidGuide(const TriangleTree& surface) : surface_(surface) {}
  Vec3 place(NodeKind kind, const Vec3& p) const override;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind kind,
                                                               const Vec3& p) const override;

 private:
  const TriangleTree& surface_;
};

}  // namespace coxa::meshing
