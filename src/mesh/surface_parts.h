#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa {

/// Triangles around every vertex, grouped by walking over edges that two triangles share: one group
/// at a manifold vertex, several where sheets touch.
std::vector<std::vector<std::vector<Index>>> vertex_fans(const TriMesh& mesh);

/// Whether triangle t runs along its edge from a to b (and not from b to a).
bool runs_along(const TriMesh& mesh, Index t, Index a, Index b);

/// For closed pieces: which are turned inside out, cavities within others counted as such.
/// @param piece_of number of the piece of every triangle
std::vector<bool> inward_pieces(const TriMesh& mesh, const std::vector<Index>& piece_of);

}  // namespace coxa
