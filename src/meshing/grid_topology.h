#pragma once

#include "tet_grid.h"

#include <array>
#include <vector>

namespace coxa::meshing {

using Facet = std::array<Index, 3>;

/// Whether the element has the corner v.
bool contains(const Tet& t, Index v);
/// The three corners other than corner number `corner`, seen from outside for positive volume.
Facet facet_opposite(const Tet& t, std::size_t corner);
/// Whether a facet of an element belongs to that element only.
bool on_boundary(const TetGrid& grid, const Facet& f);
bool edge_on_boundary(const TetGrid& grid, Index a, Index b);
bool node_on_boundary(const TetGrid& grid, Index v);
/// Whether some element has the edge.
bool has_edge(const TetGrid& grid, Index a, Index b);

/// Whether some element has the face.
bool has_face(const TetGrid& grid, Index a, Index b, Index c);

/// The corners around an edge a-b, counter-clockwise seen from b.
struct EdgeRing {
  std::vector<Index> corners;
  bool closed = true;       ///< all around; otherwise from one boundary facet to another
  std::vector<Index> tets;  ///< around the edge
};
/// @returns no corner where the elements around the edge form more than one fan
EdgeRing ring_around(const TetGrid& grid, Index a, Index b);

/// Nodes of boundary facets: 1 per node.
std::vector<char> boundary_nodes(const TetGrid& grid);

}  // namespace coxa::meshing
