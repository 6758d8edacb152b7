#pragma once

#include "tet_grid.h"

namespace coxa::meshing {

/// Where boundary nodes slide.
class SlideGuide {
 public:
  virtual ~SlideGuide() = default;
  /// The nearest place a node of this kind may take.
  virtual Vec3 place(NodeKind kind, const Vec3& p) const = 0;
  /// Orthonormal directions (columns) in which a node of this kind at p may move, 3, 2, 1 or 0.
  virtual Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind kind,
                                                                       const Vec3& p) const = 0;
};

/// Two orthonormal directions (columns) at right angles to the unit vector n.
Eigen::Matrix<double, 3, 2> tangents(const Vec3& n);

}  // namespace coxa::meshing
