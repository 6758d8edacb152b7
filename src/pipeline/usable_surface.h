#pragma once

#include <coxa/core/monitor.h>
#include <coxa/mesh/tri_mesh.h>
#include <coxa/pipeline/record.h>

#include <string>

namespace coxa::pipeline {

/// A surface made valid: as it is where it is valid; otherwise repaired or evened out, whichever
/// moves it less, or made anew, with what was changed as warnings of the record.
/// @throws Error bad_mesh naming the place if it cannot be used
TriMesh usable_surface(const TriMesh& surface, const std::string& name, Record& record,
                       const Monitor& monitor);

}  // namespace coxa::pipeline
