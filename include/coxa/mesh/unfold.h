#pragma once

#include <coxa/mesh/tri_mesh.h>

namespace coxa {

/// Evens the neighbourhoods of triangles that cut each other until none is left, or until it does
/// not help any more. Vertices elsewhere stay where they are.
/// @returns true when no triangle cuts another
bool update_unfolded(TriMesh& mesh);

}  // namespace coxa
