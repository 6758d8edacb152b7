#pragma once

#include <coxa/geom/triangle_tree.h>
#include <coxa/shape/registration.h>

#include <utility>
#include <vector>

namespace coxa::shape {

/// Pulls on the vertices of the moving surface.
struct Pulls {
  Points displacement;  ///< V×3, mm; 0 where there is none
  VecX weight;          ///< V, 0 where there is none
};

/// What pulls need to know of the surface that does not move.
///
/// @note refers to the surface, which must outlive it.
class PullTarget {
 public:
  explicit PullTarget(const TrustedSurface& surface);

  /// Nearest points both ways between trusted, compatible places; border to border.
  Pulls pulls_on(const TrustedSurface& moving, const RegistrationOptions& options) const;
  /// From the moving vertices to this surface only.
  Pulls forward_pulls(const TrustedSurface& moving, const RegistrationOptions& options) const;

 private:
  void add_forward(const TrustedSurface& moving, const RegistrationOptions& options,
                   Pulls& pulls) const;
  void add_backward(const TrustedSurface& moving, const RegistrationOptions& options,
                    Pulls& pulls) const;
  void add_border(const TrustedSurface& moving, const RegistrationOptions& options,
                  Pulls& pulls) const;

  const TrustedSurface* surface_;
  TriangleTree tree_;
  Points vertex_normals_, triangle_normals_;
  std::vector<std::pair<Index, Index>>
      border_;  ///< edges of the border; empty for a closed surface
};

/// Edges with one triangle, directed as in it.
std::vector<std::pair<Index, Index>> border_edges(const TriMesh& mesh);

}  // namespace coxa::shape
