#pragma once

#include <coxa/medial/surface_sides.h>
#include <coxa/meshing/mesh_surface.h>

namespace coxa::meshing {

/// Fills a sheet by its medial grid.
/// @throws Error as `mesh_surface`
MeshingResult mesh_sheet(const TriMesh& surface, const medial::SurfaceSides& sides,
                         const MeshingOptions& options, const Monitor& monitor);

}  // namespace coxa::meshing
