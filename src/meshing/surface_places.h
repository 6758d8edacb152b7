#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::meshing {

/// Places of a surface that the boundary of a mesh may miss: its vertices, the middles of its
/// edges, and places along its ridges (edges where it bends by more than 25 degrees), `spacing` mm
/// apart or nearer.
std::vector<Vec3> places_on(const TriMesh& surface, double spacing);

/// Places within the triangles that are longer than `spacing`, mm, about as far apart.
std::vector<Vec3> places_within(const TriMesh& surface, double spacing);

}  // namespace coxa::meshing
