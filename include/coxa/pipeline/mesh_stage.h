#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tet_mesh.h>
#include <coxa/meshing/mesh_surface.h>
#include <coxa/pipeline/stage.h>

#include <filesystem>

namespace coxa::pipeline {

/// One surface file into one mesh file, with `<stem>.json` beside it.
struct MeshRequest {
  std::filesystem::path surface;  ///< PLY, STL, OBJ or VTP
  std::filesystem::path
      bone;  ///< the bone it lies on, for the facets' tags; empty: the larger face is articular
  meshing::MeshingOptions options;
};

/// Reads, checks, repairs where that is safe, fills with tetrahedra, writes; what was changed of
/// the surface is to be seen in `<stem>_repaired.ply` beside the mesh.
/// @throws Error bad_mesh naming the place if the surface cannot be used
Record run_mesh_file(const MeshRequest& request, const std::filesystem::path& out,
                     const Monitor& monitor);

/// Both cartilages of a segment stage into `folder`: femoral_cartilage.vtu and
/// acetabular_cartilage.vtu, with facets tagged by the bones.
Record run_mesh_stage(const std::filesystem::path& segment_folder,
                      const meshing::MeshingOptions& options, const std::filesystem::path& folder,
                      Reuse reuse, const Monitor& monitor);

}  // namespace coxa::pipeline
