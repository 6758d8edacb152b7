#pragma once

#include <coxa/mesh/repair.h>

#include <vector>

namespace coxa {

/// The triangles not marked, and the vertices they use. @throws Error bad_mesh if none is left
TriMesh without_marked(const TriMesh& mesh, const std::vector<bool>& marked);

/// Drops patches that hang on an edge with more than two triangles and end in the open: sheets
/// without thickness. The largest patch stays.
TriMesh drop_hanging_sheets(TriMesh mesh, RepairReport& report);

/// Parts the surface along edges with more than two triangles: the two sides of each wedge of the
/// body stay together and get a new vertex at the middle of the edge, drawn inwards a little.
/// @throws Error bad_mesh where as many triangles do not run along the edge as against it
TriMesh part_at_crowded_edges(const TriMesh& mesh, RepairReport& report);

/// Doubles the vertices in which sheets touch, each copy drawn a little into its own sheet's
/// inside.
TriMesh split_touching_sheets(TriMesh mesh, RepairReport& report);

}  // namespace coxa
