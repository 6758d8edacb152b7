#pragma once

#include "host_patch.h"

namespace coxa::segment {

/// How far a border is looked for, and how far beyond what is seen a layer goes on.
struct RimReach {
  double search = 0.0;  ///< mm, to both sides of the present border
  double hidden = 0.0;  ///< mm, width of the thin margin that the image does not show
};

/// Moves the border of a sheet along its host to where covered turns to bare, and the rest of the
/// sheet along with it.
///
/// Every border vertex may go up to `reach.search` mm across the rim, on the host, and then
/// `reach.hidden` further outwards. The ways are chosen
/// together: the most covered ground inside and bare ground outside, near places preferred and
/// neighbours alike (dynamic programming around each loop).
/// @param score per patch vertex, in [-1, 1]: covered, bare
/// @returns the sheet with new points, on the patch
TriMesh sheet_to_rim(const TriMesh& sheet, const HostPatch& patch, const VecX& score,
                     const RimReach& reach);

}  // namespace coxa::segment
