#pragma once

#include <coxa/segment/body.h>
#include <coxa/segment/segment.h>

namespace coxa::segment {

/// Figures of a finished body from its last match.
StructureQuality quality_of(const Body& body);

/// Dual surface of the finest mesh with the fields `confidence` and `completed`.
Surface surface_of(const Body& body);

/// The surface of the other side of the body.
Surface mirrored(Surface surface);

}  // namespace coxa::segment
