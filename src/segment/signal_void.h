#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/profile_search.h>

#include <span>
#include <vector>

namespace coxa::segment {

/// How much of the bones has no signal inside them within 6 mm to every side, ml; of several images
/// the one that shows least of it.
///
/// Marrow always gives some signal, even where fat is suppressed, and cortex is thinner: metal does
/// not, and takes its surroundings with it.
double signal_void(const std::vector<TriMesh>& bones, std::span<const PreparedImage> images);

}  // namespace coxa::segment
