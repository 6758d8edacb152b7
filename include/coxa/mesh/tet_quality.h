#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tet_mesh.h>

#include <vector>

namespace coxa {

/// Dihedral angles at the edges 01 02 03 12 13 23.
using TetDihedrals = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// Signed volume of every tetrahedron, mm³. M values.
VecX tet_volumes(const Points& points, const Tets& tets);
/// 3 r_in / R, inscribed over circumscribed radius: 1 for the regular tetrahedron, 0 where the
/// volume is not positive. M values.
VecX tet_aspects(const Points& points, const Tets& tets);
/// Dihedral angles, rad (regular: 1.2310). M×6.
TetDihedrals tet_dihedrals(const Points& points, const Tets& tets);

/// Figures of a whole mesh, by the definitions of the mesh generation literature (docs/mesh.md).
struct TetQuality {
  Index n_tets = 0;
  Index n_inverted = 0;        ///< volume <= 0
  double volume = 0.0;         ///< mm³
  double dihedral_mean = 0.0;  ///< rad; all angles of all tetrahedra
  double dihedral_min = 0.0;   ///< rad
  double dihedral_max = 0.0;   ///< rad
  double aspect_mean = 0.0;
  double aspect_p05 = 0.0;  ///< 5th percentile
  double aspect_min = 0.0;
};
/// @throws Error bad_mesh if there is no tetrahedron or an index is out of range
TetQuality tet_quality(const Points& points, const Tets& tets);

/// Faces that belong to one tetrahedron only, outward for positive volumes, in the order of the
/// tetrahedra. B×3.
/// @param owners  if not null, receives the tetrahedron of each facet
Triangles boundary_facets(const Tets& tets, std::vector<Index>* owners = nullptr);

}  // namespace coxa
