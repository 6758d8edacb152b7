#pragma once

#include <coxa/mesh/topology.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::segment {

/// The part of a host's surface about a layer, with triangles a quarter of the host's.
struct HostPatch {
  TriMesh mesh;
  Points normals;                  ///< outward
  std::vector<Index> host_vertex;  ///< of the first vertices; the others are middles of edges
  Adjacency neighbours;
  VecX rim_distance;  ///< mm along the host, roughly: positive under the layer, negative beside it
};

/// @param sheet the side of the layer that lies on the host   @param reach mm, beside the layer
HostPatch patch_about(const TriMesh& host, const TriMesh& sheet, double reach);

/// Weighted means with the neighbours, `passes` times; a vertex without weight takes what reaches
/// it. `weight` is smoothed too.
VecX smoothed_on(const HostPatch& patch, const VecX& values, VecX weight, int passes);

}  // namespace coxa::segment
