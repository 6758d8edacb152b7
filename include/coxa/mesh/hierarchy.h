#pragma once

#include <coxa/mesh/simplex_mesh.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa {

struct HierarchyOptions {
  int n_levels = 4;    ///< >= 1, the finest included
  double ratio = 4.0;  ///< > 1: triangles of a level over those of the next coarser one
  Index min_triangles =
      200;  ///< >= 8: a level is never made coarser than this (levels may then be fewer)
};

/// Simplex meshes of one structure from coarse to fine.
///
/// Every coarser level is dual to a decimation of the next finer triangulation. A fine vertex
/// follows the nearest point of the coarse mesh (its faces cut into triangles) on the side that its
/// own normal looks to.
/// @param finest  closed manifold; the last level is its dual
/// @throws Error  bad_mesh if the surface is not a closed manifold; bad_input for options out of
/// range
SimplexHierarchy make_hierarchy(const TriMesh& finest, const HierarchyOptions& options = {});

/// Triangulation of the faces that uses the simplex vertices alone.
TriMesh face_triangulation(const SimplexMesh& mesh);

/// Values at the fine vertices interpolated from the coarse ones (Vcoarse×3 to Vfine×3).
Points interpolate(const LevelMap& map, const Points& coarse);
/// Weighted mean over the fine vertices that follow each coarse vertex, with the map's weights;
/// zero where none does (Vfine×3 to Vcoarse×3).
Points restrict_mean(const LevelMap& map, const Points& fine, Index n_coarse);

}  // namespace coxa
