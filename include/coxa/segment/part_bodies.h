#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::segment {

/// Parts soft closed surfaces that enter each other, or firm ones, until none is deeper than
/// `tolerance` (mm) or it does not help any more: soft ones share the way, firm ones stay.
///
/// What is more than 2 mm inside is in a wrong place altogether and stays there: it is only
/// reported. A surface that would fold stays as it was. Vertices, middles of edges and of triangles
/// of each are looked for in all others.
/// @returns the greatest depth of such a point that is left, mm; 0 where none is inside
/// @note bit-identical for any number of threads
double update_parted(const std::vector<TriMesh*>& soft, const std::vector<const TriMesh*>& firm,
                     double tolerance = 0.02, const Monitor& monitor = {});

}  // namespace coxa::segment
