#pragma once

#include <coxa/segment/body.h>

#include <span>

namespace coxa::segment {

/// Where a bone's vertices would lie if the dark line inside it were its border.
///
/// Cortical bone is dark in every contrast. A bone that has settled on the border of a muscle has
/// no dark line there, but fat and then its own cortex inside. Each vertex with nothing dark near
/// and a dark line farther in goes there; neighbours agree, vertices in place stay.
/// @returns V×3 mm, the body's own points where nothing of the kind is found
Points drawn_to_cortex(const Body& bone, std::span<const PreparedImage> images);

}  // namespace coxa::segment
