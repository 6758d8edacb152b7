#pragma once

#include <coxa/mesh/tet_mesh.h>

namespace coxa::fem {

/// Nodal forces of a constant force density, consistent with the elements' shape functions.
/// @param density N/mm³   @returns 3N values, N
VecX body_load(const TetMesh& mesh, const Vec3& density);

}  // namespace coxa::fem
