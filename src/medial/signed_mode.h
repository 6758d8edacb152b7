#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::medial {

/// Smallest cosine between opposing normals of a sheet.
constexpr double kFacing = 0.3;

/// What lies across the body from a triangle.
struct Opposite {
  Index triangle = -1;  // met by the inward ray; -1 where none
  double distance = 0.0;
  double facing = 0.0;  // minus the cosine between the two normals
};

/// Edge a-b and the two triangles it joins
struct SharedEdge {
  Index a = 0, b = 0, left = 0, right = 0;
};

/// Of triangles.
struct Geometry {
  Points centroids, normals;
  VecX areas;
};

/// @throws Error bad_mesh if the surface is open or not manifold
std::vector<SharedEdge> shared_edges(const TriMesh& surface);
Geometry triangle_geometry(const TriMesh& surface);
std::vector<Opposite> find_opposites(const TriMesh& surface, const Geometry& g);

/// Median over the area of the distance to the opposite triangle, where the two face each other.
double median_thickness(const VecX& areas, const std::vector<Opposite>& opposites);

/// Thickness over the square root of half the area.
double relative_thickness(double thickness, const VecX& areas);

/// The function on the triangles that varies least along the surface, may jump at sharp edges, and
/// takes opposite values across the body: lowest eigenvector of a signed Laplacian. Surfaces of
/// many triangles get that of a coarser one, relaxed.
VecX signed_mode(const TriMesh& surface, const std::vector<SharedEdge>& edges, const Geometry& g,
                 const std::vector<Opposite>& opposites);

}  // namespace coxa::medial
