#pragma once

#include <coxa/mesh/repair.h>

namespace coxa {

/// Cuts the triangles around self-intersections out of a closed manifold surface and fills the
/// holes, with wider cuts until nothing meets. @throws Error bad_mesh, naming the place, where that
/// fails or moves the surface more than `max_move` mm
TriMesh untangle(const TriMesh& mesh, const RepairOptions& options, RepairReport& report);

}  // namespace coxa
