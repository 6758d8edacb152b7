#pragma once

#include "solid_guide.h"
#include "tet_grid.h"

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::meshing {

struct SolidImprovement {
  int rounds = 8;      ///< >= 0, of flips and smoothing
  int max_tets = 100;  ///< elements are not made more than this
};

/// Makes a lattice within a surface good: nodes of its boundary go to the surface, and to ridges
/// and corners if the guide has feature curves; smoothing, flips and drawing to places missed
/// alternate. @returns how many poor elements at the boundary were dropped
Index improve_solid(TetGrid& grid, const SolidGuide& guide, const TriMesh& surface,
                    const SolidImprovement& options, const Monitor& monitor);

}  // namespace coxa::meshing
