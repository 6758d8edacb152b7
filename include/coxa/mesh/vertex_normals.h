#pragma once

#include <coxa/mesh/tri_mesh.h>

namespace coxa {

/// Unit normal of every triangle, outward; zero where the triangle has no area. T×3.
Points triangle_normals(const TriMesh& mesh);

/// Unit normal at every vertex, outward: triangle normals weighted by their angle at the vertex,
/// which does not depend on how the surface is cut into triangles. Zero where no triangle with area
/// meets. V×3. Source: Thürmer and Wüthrich 1998.
Points vertex_normals(const TriMesh& mesh);

}  // namespace coxa
