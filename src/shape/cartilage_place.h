#pragma once

#include <coxa/mesh/tri_mesh.h>

#include "cartilage_sheet.h"
#include "correspondence.h"

namespace coxa::shape {

/// The mean cartilage brought to where it lies on the mean bone.
///
/// Pose and size from the examples that show both (their bones taken to the mean bone), else by
/// nearest points; then the bone side is laid `gap` mm above the bone, each place taking its
/// thickness along.
/// @param cartilage mean shape of the correspondence, V×3   @param bone mean bone surface
Points placed_on_bone(const Points& cartilage, const Correspondence& correspondence,
                      const TriMesh& bone, const Correspondence& bone_correspondence, double gap);

}  // namespace coxa::shape
