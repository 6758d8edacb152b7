#pragma once

#include "host_patch.h"

namespace coxa::segment {

/// Moves the border of a sheet along its host to where covered turns to bare, and the rest of the
/// sheet along with it.
///
/// Every border vertex may go up to `reach` mm across the rim, on the host. The ways are chosen
/// together: the most covered ground inside and bare ground outside, near places preferred and
/// neighbours alike (dynamic programming around each loop).
/// @param score per patch vertex, in [-1, 1]: covered, bare
/// @returns the sheet with new points, on the patch
TriMesh sheet_to_rim(const TriMesh& sheet, const HostPatch& patch, const VecX& score, double reach);

}  // namespace coxa::segment
