#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/motion/joint_centre.h>

#include <optional>

namespace coxa::motion {

/// Triangle centres of a surface with their areas and smoothed outward normals: what sphere fits
/// work on.
struct SurfaceSamples {
  Points points;   ///< n×3, mm
  Points normals;  ///< n×3, unit, averaged over a neighbourhood so that noise does not turn them
  VecX areas;      ///< n, mm²
};
SurfaceSamples surface_samples(const TriMesh& mesh);

/// Rough centre and radius of the most sphere-like part whose normals point away from its centre;
/// nullopt when there is none.
std::optional<Vec3> find_head(const SurfaceSamples& samples, double smallest_radius,
                              double largest_radius);

/// Sphere through the head of a femur: the part of `samples` off the neck.
JointCentre fit_femoral_head(const SurfaceSamples& samples, const Vec3& start,
                             const JointCentreOptions& options);

enum class Facing { outward, inward };
/// Sphere through the triangles that face away from (outward) or towards (inward) the centre.
JointCentre fit_facing(const SurfaceSamples& samples, const Vec3& start, Facing facing,
                       const JointCentreOptions& options);

/// The triangles of a closed cartilage that face away from or towards the centre.
TriMesh facing_part(const TriMesh& mesh, const Vec3& centre, Facing facing);

}  // namespace coxa::motion
