#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <map>
#include <string>

namespace coxa {

/// A named surface with values per vertex.
struct Surface {
  TriMesh mesh;
  std::map<std::string, VecX>
      fields;  ///< name with unit (for example "confidence", "thickness_mm") -> V values
};

/// Structures of one hip by their names in the house's vocabulary (femur, hip_bone,
/// femoral_cartilage, …).
using SurfaceSet = std::map<std::string, Surface>;

}  // namespace coxa
