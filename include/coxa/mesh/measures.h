#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa {

/// Area of every triangle, mm². T values.
VecX triangle_areas(const TriMesh& mesh);
/// Surface area, mm².
double area(const TriMesh& mesh);
/// Area of every piece, mm². @param piece_of number of the piece of every triangle, from 0
VecX piece_areas(const TriMesh& mesh, const std::vector<Index>& piece_of);
/// Volume enclosed by a closed surface, mm³; negative where it is oriented inward.
double volume(const TriMesh& mesh);
/// Centre of mass of the volume enclosed by a closed surface, mm.
Vec3 volume_centroid(const TriMesh& mesh);
/// Length of every edge averaged over all triangle sides, mm.
double mean_edge_length(const TriMesh& mesh);

/// Value below which the given share (0 to 1) of the values lies, linear between neighbours; NaN
/// for none.
double percentile(VecX values, double share);

/// Axis-aligned bounds of the points, mm.
struct Bounds {
  Vec3 low = Vec3::Constant(kInfinity);
  Vec3 high = Vec3::Constant(-kInfinity);
  double diagonal() const { return (high - low).norm(); }
};
Bounds bounds(const Points& points);

}  // namespace coxa
