#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/body.h>
#include <coxa/segment/segment.h>

#include <vector>

namespace coxa::segment {

/// A bone as the atlas has it and as it was found, with the same triangles.
struct FoundBone {
  TriMesh mean, found;
};

/// Where found bones carry points between them: a thin-plate spline through points of all bones.
/// @param points N×3, mm, atlas frame   @returns N×3, mm, image frame
/// @throws Error bad_input if the bones have fewer than four points
Points carried_by_bones(const Points& points, const std::vector<FoundBone>& bones);

/// Finds muscles between bones that are found already: carried by these, moved together to what
/// looks like muscle, then each by its profiles.
/// @param models  of all muscles about the hip, so that they keep each other in place
/// @returns bodies without a preparation, in the models' order
/// @note    bit-identical for any number of threads
std::vector<Body> found_muscles(const std::vector<const shape::StructureModel*>& models,
                                const std::vector<FoundBone>& bones,
                                const std::vector<PreparedImage>& images,
                                const SegmentOptions& options, const Monitor& monitor = {});

}  // namespace coxa::segment
