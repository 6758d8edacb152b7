#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/evolve.h>

#include <span>

namespace coxa::segment {

/// A layer's shape laid on a host of another shape: bone-side vertices keep their place on the
/// host's triangles, at `gap` from them, and articular vertices their offset from the opposite
/// ones.
/// @param shape V×3 on `mean`, mm; vertex i + n_bone_side lies opposite vertex i
/// @param mean, now the host's mean surface and its present one, same triangles
Points laid_on(const Points& shape, Index n_bone_side, const TriMesh& mean, const TriMesh& now,
               double gap);

/// Where a layer's shape, laid on its segmented host, fits the images best: its leading modes are
/// varied one after the other. Where the rims lie shows along no single normal, only in how well
/// the whole fits.
/// @returns V×3, mm
Points layer_by_modes(const Body& layer, const TriMesh& mean, const TriMesh& now,
                      std::span<const PreparedImage> images, const Resolution& resolution,
                      const SegmentOptions& options);

}  // namespace coxa::segment
