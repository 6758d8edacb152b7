#pragma once

#include <coxa/meshing/mesh_surface.h>

namespace coxa::meshing {

/// Whether mesh a misses fewer limits (see `meets_limits`) than b, or as many and less of the
/// surface.
bool nearer_to_limits(const MeshingReport& a, const MeshingReport& b);

}  // namespace coxa::meshing
