#pragma once

#include <coxa/mesh/tet_mesh.h>

#include <array>
#include <vector>

namespace coxa::fem {

/// Shape functions of one element at its integration points.
struct ElementShape {
  std::vector<double> weight;  ///< n_points, mm³
  std::vector<Vec3> gradient;  ///< n_points × n_nodes, dN/dX, 1/mm
  // of the four linear functions that are 1 at one corner
  std::vector<Eigen::Vector4d> barycentric;  ///< n_points, their values
  std::vector<Vec3> corner_gradient;         ///< n_points × 4, their slopes, 1/mm
};

/// The corners that each mid node of an element lies between.
inline constexpr std::array<std::array<int, 2>, 6> kEdgeCorners{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Nodes of an element: 4, or 10 where the mesh has mid nodes.
inline int nodes_per_element(const TetMesh& mesh) { return mesh.mid_nodes.rows() > 0 ? 10 : 4; }
/// Node a of element e, corners first.
inline Index element_node(const TetMesh& mesh, Index e, int a) {
  return a < 4 ? mesh.tets(e, a) : mesh.mid_nodes(e, a - 4);
}

/// One point for four nodes, four points (exact to degree 2) for ten.
/// @throws Error bad_mesh, naming the element, where its volume is not positive
ElementShape element_shape(const TetMesh& mesh, Index e);

/// @throws Error bad_mesh if a node number is out of range or the mid nodes do not match the
/// elements
void check_connectivity(const TetMesh& mesh);

}  // namespace coxa::fem
