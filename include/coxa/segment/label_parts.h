#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/segment/muscle_labels.h>

namespace coxa::segment {

/// Unlabels pieces (voxels linked by faces) of less than a share of their label's largest piece.
void drop_small_parts(BodyLabels& labels, int n_labels, double least_share);

/// The surface about the voxels of one label, between them where the depths vanish in and out of
/// them (shape-based interpolation, Raya and Udupa 1990); beyond the view it is the body's own.
/// Its triangles are uneven.
/// @returns an empty mesh where nothing has the label
/// @param spacing mm, > 0, of the samples that it goes through
TriMesh label_surface(const BodyLabels& labels, int label, const TriMesh& body, double spacing);

}  // namespace coxa::segment
