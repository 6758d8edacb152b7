#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::segment {

/// A closed layer as the sheet on its host and, for every vertex of it, the one opposite.
///
/// Triangle i + n of the layer lies opposite its triangle i; the sheet's vertices come first.
struct LayerSheet {
  TriMesh sheet;                ///< its normals look into the host
  std::vector<Index> opposite;  ///< per sheet vertex: the layer's vertex, itself at the rim
};

/// @param n_bone_side number of triangles on the host's side
LayerSheet sheet_of(const TriMesh& layer, Index n_bone_side);

/// Per sheet vertex, mm: distance to the vertex opposite.
VecX thickness_of(const LayerSheet& layer, const Points& points);

}  // namespace coxa::segment
