#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <span>
#include <string>
#include <vector>

namespace coxa {

/// Lists of varying length, one after another in one array.
struct Adjacency {
  std::vector<Index> begin{0};  ///< n+1 offsets into items
  std::vector<Index> items;

  Index size() const { return static_cast<Index>(begin.size()) - 1; }
  std::span<const Index> operator[](Index i) const {
    const auto from = static_cast<std::size_t>(begin[static_cast<std::size_t>(i)]);
    return {items.data() + from,
            static_cast<std::size_t>(begin[static_cast<std::size_t>(i) + 1]) - from};
  }
};

/// Undirected edges of a triangulation.
struct MeshEdges {
  Eigen::Matrix<Index, Eigen::Dynamic, 2, Eigen::RowMajor>
      vertices;           ///< E×2, lower first; rows sorted
  Triangles of_triangle;  ///< T×3: edge k joins corners k and k+1
  Adjacency triangles;    ///< triangles around each edge, ascending: 1 on a border, 2 inside
};
MeshEdges mesh_edges(const TriMesh& mesh);

/// Triangles around each vertex, ascending.
Adjacency vertex_triangles(const TriMesh& mesh);
/// Vertices joined to each vertex by an edge, ascending.
Adjacency vertex_neighbours(const TriMesh& mesh);

/// Number of the edge-connected piece of every triangle; pieces are numbered by their first
/// triangle.
std::vector<Index> triangle_components(const TriMesh& mesh);
/// Closed loops of border edges, each starting at its lowest vertex, directed with the border
/// edges' triangles; loops sorted by their first vertex. @throws Error bad_mesh where loops touch
/// in a vertex.
std::vector<std::vector<Index>> boundary_loops(const TriMesh& mesh);
/// V - E + F, counting the vertices that are used.
Index euler_characteristic(const TriMesh& mesh);
/// Handles, summed over the pieces of a closed manifold: sphere 0, torus 1.
Index genus(const TriMesh& mesh);

/// Why this is not a closed, consistently oriented manifold without stray vertices, with the place
/// (vertex numbers and mm); empty when it is one.
std::string manifold_fault(const TriMesh& mesh);
/// @throws Error bad_mesh with `what` and the fault, unless `mesh` is a closed oriented manifold.
void require_closed_manifold(const TriMesh& mesh, const std::string& what);

/// The listed triangles and the vertices they use, both in their old order.
struct SubMesh {
  TriMesh mesh;
  std::vector<Index> vertex_of;  ///< old number of every vertex kept
};
SubMesh sub_mesh(const TriMesh& mesh, std::span<const Index> triangles);

}  // namespace coxa
