#pragma once

#include "tet_grid.h"

#include <coxa/mesh/tet_mesh.h>

namespace coxa::meshing {

/// The result: nodes in use renumbered in order, boundary facets with their tags.
///
/// First face -> bone_side, second face -> articular_side, facets that join both -> rim.
TetMesh to_tet_mesh(const TetGrid& grid);

}  // namespace coxa::meshing
