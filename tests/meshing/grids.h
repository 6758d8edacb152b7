#pragma once

#include <coxa/mesh/tet_quality.h>
#include <coxa/mesh/topology.h>

#include "meshing/tet_boundary.h"
#include "meshing/tet_grid.h"

#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace coxa::meshing::test {

inline TetGrid make_grid(std::vector<Vec3> x, std::vector<Tet> tets) {
  TetGrid grid;
  grid.kinds.assign(x.size(), NodeKind::first_face);
  grid.levels.assign(x.size(), 0.0);
  grid.x = std::move(x);
  grid.tets = std::move(tets);
  grid.link();
  return grid;
}

inline double volume_of(const TetGrid& grid) {
  const TetMesh mesh = to_tet_mesh(grid);
  return tet_volumes(mesh.points, mesh.tets).sum();
}

inline double least_volume(const TetGrid& grid) {
  const TetMesh mesh = to_tet_mesh(grid);
  return tet_volumes(mesh.points, mesh.tets).minCoeff();
}

/// The boundary without the nodes inside.
inline TriMesh envelope(const TetMesh& mesh) {
  std::vector<Index> all(static_cast<std::size_t>(mesh.facets.rows()));
  std::iota(all.begin(), all.end(), 0);
  return sub_mesh({mesh.points, mesh.facets}, all).mesh;
}

inline std::string boundary_fault(const TetGrid& grid) {
  return manifold_fault(envelope(to_tet_mesh(grid)));
}

}  // namespace coxa::meshing::test
