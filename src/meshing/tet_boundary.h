#pragma once

#include "tet_grid.h"

#include <coxa/mesh/tet_mesh.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::meshing {

/// Facets of one element only, outward, by the grid's node numbers, in order of their corners.
Triangles boundary_of(const TetGrid& grid);

/// The boundary as a surface, with all nodes of the grid.
TriMesh boundary_surface(const TetGrid& grid);

/// The result: nodes in use renumbered in order, boundary facets with their tags.
///
/// First face -> bone_side, second face -> articular_side, facets that join both -> rim.
TetMesh to_tet_mesh(const TetGrid& grid);

}  // namespace coxa::meshing
