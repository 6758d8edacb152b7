#pragma once

#include <coxa/core/monitor.h>
#include <coxa/core/types.h>
#include <coxa/pipeline/stage.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace coxa::pipeline {

struct SurfaceRequest {
  std::map<std::string, std::filesystem::path> surfaces;  ///< by structure
  Side side = Side::right;
  /// Labrum and ligaments to be made beside them; other names are those of the surfaces.
  std::vector<std::string> structures = {};
};

/// Takes surfaces segmented elsewhere in place of a segment stage: checked, repaired where they
/// need it (with what was changed as warnings), written as a segment stage writes them, with the
/// record `segment.json`.
/// @throws Error bad_mesh naming the structure and the fault for a surface that cannot be repaired
Record run_surface_stage(const SurfaceRequest& request, const std::filesystem::path& folder,
                         Reuse reuse, const Monitor& monitor);

}  // namespace coxa::pipeline
