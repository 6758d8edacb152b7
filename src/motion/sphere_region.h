#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/fits.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/motion/joint_centre.h>

#include <optional>
#include <vector>

namespace coxa::motion {

/// Triangle centres of a surface with their areas and smoothed outward normals: what sphere fits
/// work on.
struct SurfaceSamples {
  Points points;   ///< n×3, mm
  Points normals;  ///< n×3, unit, averaged over a neighbourhood so that noise does not turn them
  VecX areas;      ///< n, mm²
};
SurfaceSamples surface_samples(const TriMesh& mesh);

/// n unit directions, evenly spread on a spiral.
Points spiral_directions(Index n);
/// Direction of the neck: from the head's centre to the bone a little farther out than the head.
Vec3 neck_direction(const SurfaceSamples& samples, const Vec3& centre, double radius);

/// Which triangles belong to a sphere.
struct RegionRule {
  double sign = 1.0;         ///< +1: facing away from the centre
  double band = 4.0;         ///< mm about the radius
  Vec3 neck = Vec3::Zero();  ///< unit; zero: no neck to leave out
  double neck_cosine = 1.0;
};
std::vector<Index> find_region(const SurfaceSamples& samples, const Sphere& sphere,
                               const RegionRule& rule);

struct RegionFit {
  Sphere sphere;
  std::vector<Index> region;
};
/// Alternates between choosing the off-neck region and fitting it, with a band that narrows from 6
/// to 2 mm.
RegionFit fit_off_neck(const SurfaceSamples& samples, const Sphere& first,
                       const JointCentreOptions& options);
/// The sphere that a fit of the femoral head starts from.
Sphere first_sphere(const SurfaceSamples& samples, const Vec3& start);

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
