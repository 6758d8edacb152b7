#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/shape/atlas.h>

#include <optional>
#include <vector>

namespace coxa::segment {

/// For each structure, the number of the one it lies on: a much larger structure whose mean surface
/// touches a good part of its own. Bones lie on nothing, a cartilage lies on its bone.
std::vector<std::optional<std::size_t>> find_hosts(
    const std::vector<const shape::StructureModel*>& structures);

/// 1 for every finest vertex of the mean shape that lies on the host's mean surface and faces it,
/// else 0.
VecX seated_vertices(const shape::StructureModel& layer, const TriMesh& host_mean);

/// A place on a surface with axes that turn along with it.
struct TriangleFrame {
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns: first edge, in-plane, normal
};

/// Frame of a triangle at barycentric coordinates.
TriangleFrame triangle_frame(const TriMesh& mesh, Index triangle, const Vec3& barycentric);

/// Points near a surface carried along when that surface changes: each keeps its place relative to
/// the nearest triangle's frame.
/// @param now  the surface after the change, same triangles as `before`
Points carried_points(const Points& points, const TriMesh& before, const TriMesh& now);

}  // namespace coxa::segment
