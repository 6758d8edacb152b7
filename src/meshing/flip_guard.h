#pragma once

#include "slide_guide.h"
#include "tet_grid.h"

#include <optional>

namespace coxa::meshing {

/// Keeps changes of the connections from changing the boundary's topology or leaving the surface.
class FlipGuard {
 public:
  /// @param guide  must outlive the guard   @param tolerance  mm   @param at_creases  of a solid:
  /// facets beside its creases and corners may change too
  FlipGuard(const SlideGuide& guide, double tolerance, bool at_creases = false)
      : guide_(guide), tolerance_(tolerance), at_creases_(at_creases) {}

  /// Whether the boundary facets a-b-p and a-b-q may become a-p-q and b-p-q.
  bool allows_swap(const TetGrid& grid, Index a, Index b, Index p, Index q) const;
  /// Whether an element with these facets may be taken away, which leaves a-p-q and b-p-q.
  bool allows_peeling(const TetGrid& grid, Index a, Index b, Index p, Index q) const;
  /// Whether node b may merge into its neighbour a.
  bool allows_collapse(const TetGrid& grid, Index a, Index b) const;

 private:
  /// The face on which nodes of both kinds lie, at least one of them sliding; nullopt where none.
  std::optional<NodeKind> face_of(NodeKind a, NodeKind b) const;
  /// Whether facets a-p-q and b-p-q are as near to the surface as a-b-p and a-b-q and look the same
  /// way.
  bool keeps_shape(const TetGrid& grid, Index a, Index b, Index p, Index q) const;
  /// Whether node b lies on a crease and may go along it to a.
  bool along_crease(const TetGrid& grid, Index a, Index b) const;
  double departure(NodeKind kind, const Vec3& a, const Vec3& b, const Vec3& c) const;

  const SlideGuide& guide_;
  double tolerance_;
  bool at_creases_;
};

}  // namespace coxa::meshing
