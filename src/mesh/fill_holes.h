#pragma once

#include <coxa/mesh/repair.h>

namespace coxa {

/// Closes every border of an oriented manifold surface with triangles of least total area that make
/// no edge twice. Adds to the report. @throws Error bad_mesh for a border longer than `max_hole` mm
/// Source: Barequet and Sharir 1995.
TriMesh fill_holes(const TriMesh& mesh, double max_hole, RepairReport& report);

}  // namespace coxa
