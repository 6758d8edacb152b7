#pragma once

#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/tet_mesh.h>

#include <array>

namespace coxa::meshing {

/// Corners and mid-edge nodes of a ten-node element, in VTK's order.
using TenNodes = std::array<Vec3, 10>;

TenNodes ten_nodes(const TetMesh& mesh, Index t);

/// Least and largest Bernstein coefficient of the Jacobian determinant of a ten-node element, mm³:
/// the determinant, a cubic polynomial, lies between them everywhere in the element.
struct JacobianBounds {
  double least = 0.0, largest = 0.0;
};
/// Source: Johnen, Remacle and Geuzaine 2013.
JacobianBounds jacobian_bounds(const TenNodes& nodes);

struct MidNodeReport {
  Index n_curved = 0;        ///< mid-edge nodes moved off the middle of their edge
  Index n_relaxed = 0;       ///< of these, drawn back towards it to keep elements valid
  double least_ratio = 1.0;  ///< least Jacobian determinant of an element over that of its corners
};

/// Makes four-node elements ten-node ones: a node in the middle of every edge, on the surface where
/// the edge lies on the boundary.
///
/// A boundary node moves by at most a fifth of its edge. Where an element's Jacobian determinant
/// could fall below a fifth of its corners' value, its nodes are drawn back until it cannot.
/// @param mesh  straight elements of positive volume, with their boundary facets
MidNodeReport update_to_ten_nodes(TetMesh& mesh, const TriangleTree& surface);

}  // namespace coxa::meshing
