#pragma once

#include <coxa/meshing/mesh_surface.h>

namespace coxa::meshing {

/// Fills any closed surface from a lattice whose cubes follow its shape.
/// @throws Error below_quality if nothing can be filled; cancelled
MeshingResult mesh_solid(const TriMesh& surface, const MeshingOptions& options,
                         const Monitor& monitor);

}  // namespace coxa::meshing
