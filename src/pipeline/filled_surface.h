#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/meshing/mesh_surface.h>
#include <coxa/pipeline/record.h>

#include <string>

namespace coxa::pipeline {

/// Whether the two faces of a sheet must be told apart in the outcome.
enum class Faces { needed, any };

/// The surface filled as it is; a sheet that cannot be, with its triangles made even or made anew
/// where its faces are needed, or else like a solid body.
meshing::MeshingResult filled_surface(const TriMesh& surface,
                                      const meshing::MeshingOptions& options, Faces faces,
                                      const std::string& name, Record& record,
                                      const Monitor& monitor);

}  // namespace coxa::pipeline
