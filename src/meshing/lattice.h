#pragma once

#include "octree.h"
#include "tet_grid.h"

#include <coxa/geom/triangle_tree.h>

#include <vector>

namespace coxa::meshing {

/// Tetrahedra that fill the root cube of an octree: body-centred cubic where neighbouring cubes are
/// of one size, halves and quarters of such elements between sizes.
struct Lattice {
  std::vector<Vec3> points;     ///< mm
  std::vector<char> is_centre;  ///< per point: 1 in the middle of a cube
  std::vector<Tet> tets;        ///< positive volume
};

/// Source: Labelle and Shewchuk 2007, "Isosurface stuffing", section 4.
Lattice make_lattice(const Octree& octree);

/// The part of a lattice inside a closed surface.
///
/// Lattice points nearer to the surface than about a quarter of an edge are moved onto it along
/// that edge; elements that the surface still cuts are cut. Points where the outcome would touch
/// itself stay where they are, so that its boundary is always a closed manifold.
/// @returns linked; boundary nodes are first_face and near the surface, the rest inside
/// Source: the same, sections 3.1-3.3; the choice of diagonals and the care for manifoldness are
/// ours.
TetGrid stuffed(const Lattice& lattice, const TriangleTree& surface);

/// Nodes whose elements do not form one solid wedge or ball: where the boundary touches itself.
/// @param grid  linked
std::vector<Index> pinched_nodes(const TetGrid& grid);

}  // namespace coxa::meshing
