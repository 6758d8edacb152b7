#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

namespace coxa::meshing {

/// Keeps changes of the connections from changing the boundary's topology or leaving the surface.
class FlipGuard {
 public:
  /// @param guide  must outlive the guard   @param tolerance  mm
  FlipGuard(const SlideGuide& guide, double tolerance) : guide_(guide), tolerance_(tolerance) {}

  /// Whether the boundary facets a-b-p and a-b-q may become a-p-q and b-p-q.
  bool allows_swap(const TetGrid& grid, Index a, Index b, Index p, Index q) const;
  /// Whether node b may merge into its neighbour a.
  bool allows_collapse(const TetGrid& grid, Index a, Index b) const;

 private:
  double departure(NodeKind kind, const Vec3& a, const Vec3& b, const Vec3& c) const;

  const SlideGuide& guide_;
  double tolerance_;
};

}  // namespace coxa::meshing
