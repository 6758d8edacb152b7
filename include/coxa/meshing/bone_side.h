#pragma once

#include <coxa/mesh/tet_mesh.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::meshing {

/// Which face of a curved sheet lies on the bone when no bone surface is at hand.
enum class BoneFace {
  concave,  ///< the inner, smaller face: cartilage of a head
  convex    ///< the outer, larger face: cartilage of a socket
};

/// Exchanges the tags bone_side and articular_side, if needed, so that the face nearer to the bone
/// has the tag bone_side.
///
/// @param mesh  facets tagged by `mesh_surface`   @param bone  surface of the bone, mm
/// @returns     mean distances of both faces to the bone: bone side, articular side, mm
/// @throws Error bad_input if a side has no facet or the bone has no triangle
struct FaceDistances {
  double bone_side = 0.0, articular_side = 0.0;
};
FaceDistances update_bone_side(TetMesh& mesh, const TriMesh& bone);

/// The same from the curvature of the sheet: the concave face is the one with less area.
void update_bone_side(TetMesh& mesh, BoneFace face);

/// Tags what of a mesh without tagged facets, as from a lattice, lies on a bone: facets within 1 mm
/// of it that look at it are bone side. Where these are a quarter of the boundary or more, the body
/// is a layer on the bone: facets that look away from the bone are its articular side, those
/// between its rim. Otherwise the rest stays untagged.
///
/// @returns area of the bone side, mm²; 0 where the body does not lie on the bone
/// @throws Error bad_input if the bone has no triangle
double tag_bone_side(TetMesh& mesh, const TriMesh& bone);

}  // namespace coxa::meshing
