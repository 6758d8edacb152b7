#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa {

struct RebuildOptions {
  double spacing = 0.4;  ///< mm, > 0: of the grid; walls and gaps thinner than it are lost
  double opening = 0.0;  ///< mm, >= 0: what is thinner than twice this is dropped, and rims are
                         ///< rounded with this radius
  double smoothing =
      0.0;  ///< mm, >= 0: standard deviation of a Gaussian over the distances, which rounds rims
            ///< and evens what is rougher; walls three times as thick hardly move
  double thickening = 0.0;  ///< mm, >= 0: parts of the old surface that would be left out, thinner
                            ///< than the grid can see, become walls with this on both sides of them
  double target_edge = 0.8;  ///< mm, > 0
  double max_move = 1.0;  ///< mm, >= 0. Refused where the new surface is farther from the old one.
  double max_loss = kInfinity;  ///< mm, >= 0. Refused where the old one reaches farther out.
};

struct Rebuilt {
  TriMesh mesh;
  double largest_move = 0.0;    ///< mm, largest distance of the new surface from the old one
  double largest_loss = 0.0;    ///< mm, how far the old surface reaches out of the new one at most
  double thickened_area = 0.0;  ///< mm², of the old surface where walls were made of it
};

/// A new closed surface around whatever the old one encloses: for surfaces that `repair` refuses.
///
/// A grid sample is inside where most of six axis directions say so by counting directed crossings,
/// so holes, inner walls, doubled sheets and wrong orientations in places do not matter. The zero
/// level of the distance signed so is remeshed, unless even triangles fold; pieces below a
/// hundredth of the largest one's area are dropped.
/// @throws Error   bad_mesh if nothing is enclosed, or the new surface would be farther off than
///                 `max_move`; below_quality if it would leave out more than `max_loss`
Rebuilt rebuild(const TriMesh& mesh, const RebuildOptions& options = {});

}  // namespace coxa
