#pragma once

#include <coxa/shape/build_atlas.h>

#include <string>
#include <vector>

namespace coxa::shape {

/// The examples of one structure with the same triangles.
struct Correspondence {
  Triangles triangles;
  std::vector<Points> vertices;  ///< per example, V×3, hip frame
  std::vector<VecX> observed;    ///< per example, V: 1 where the example shows the vertex, else 0
  std::vector<const HipExample*> examples;  ///< likewise
  Index n_bone_side = 0;                    ///< of a cartilage: its first triangles lie on the bone
};

/// 1 for every point within `reach` mm of a trusted place of the example, else 0.
VecX observed_in(const Points& points, const TrustedSurface& example, double reach);

/// @throws Error bad_input if no example has the structure
Correspondence correspond_bone(const std::string& name, const std::vector<HipExample>& examples,
                               const StructureOptions& structure,
                               const RegistrationOptions& options, const Monitor& monitor);

/// A cartilage's bone side is registered as a sheet, border to border; the articular side follows
/// from the thickness above every vertex.
/// @param bone the structure it lies on
Correspondence correspond_cartilage(const std::string& name, const std::string& bone,
                                    const std::vector<HipExample>& examples,
                                    const StructureOptions& structure,
                                    const RegistrationOptions& options, const Monitor& monitor);

}  // namespace coxa::shape
