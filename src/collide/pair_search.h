#pragma once

#include <coxa/collide/surface_contact.h>

#include <vector>

namespace coxa::collide {

/// The surface that samples look for, at its current position.
struct OtherSurface {
  const TriangleTree& tree;
  const Points& vertex_normals;  ///< V×3, unit
  const Triangles& neighbours;   ///< across the edges, -1: border
  const std::vector<bool>& boundary_vertex;
};

/// Point of the other surface that a sample faces.
struct FacedPoint {
  Index triangle = 0;
  Vec3 barycentric = Vec3::Zero();  ///< may leave [0, 1] slightly with smooth normals
  Vec3 normal = Vec3::Zero();       ///< unit, away from the other surface
  double share = 1.0;               ///< in (0, 1], by how well the sample faces it
};

/// What a search for the point that a sample faces comes to.
struct SampleSearch {
  std::optional<FacedPoint> faced;      ///< nullopt where nothing near enough is faced
  std::optional<NearestPoint> nearest;  ///< nullopt beyond the search distance
  bool outside = true;                  ///< of the other surface; told of what is not faced
};

/// How a search makes use of the triangle that was nearest before.
enum class SearchHint {
  bounds,   ///< it bounds the search, whose answer is the nearest point of all
  followed  ///< the answer is the nearest point that a walk from there over the edges leads to; the
            ///< nearest of all where the walk leads to no triangle's inside
};

/// What a sample at `point` with outward normal `normal` faces.
/// @param before  triangle that was nearest before, or -1
SampleSearch find_faced_point(const OtherSurface& other, const Vec3& point, const Vec3& normal,
                              Index before, SearchHint hint, const ContactOptions& options);

/// How far the smooth surface stands out from each edge of each triangle: the patch over a triangle
/// is higher than the facet by the sum of bulge times both corners' weights, over its edges (edge k
/// joins corners k and k+1).
///
/// Half the sum of the distances of each end from the other's tangent plane: exact to leading order
/// on spheres.
/// @returns T×3, mm
Points edge_bulges(const TriMesh& mesh);

/// Height of the patch at barycentric weights, mm; 0 where `bulges` is empty.
double bulge(const Points& bulges, Index triangle, const Vec3& barycentric);

}  // namespace coxa::collide
