#pragma once

#include <coxa/mesh/tri_mesh.h>

namespace coxa {

/// The surface of a grid with even triangles of the length asked for or less; where they fold at
/// sharp rims and in thin walls, with more that follow the shape.
///
/// @param raw      closed manifold that does not cut itself
/// @param spacing  of the grid, mm: how far around triangles that would cut each other it is kept
/// @returns        closed manifold that does not cut itself
TriMesh fewer_triangles(const TriMesh& raw, double target_edge, double spacing);

}  // namespace coxa
