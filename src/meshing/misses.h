#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::meshing {

/// A place and how far it is from what should pass through it, mm.
struct Miss {
  Vec3 p = Vec3::Zero();
  double distance = 0.0;
};

/// How far the surface is from the boundary of a mesh, by vertices, edge middles, ridges and places
/// within large triangles, and the boundary from the surface, by edge middles and centroids of its
/// facets.
std::vector<Miss> misses(const TriMesh& boundary, const TriMesh& surface);
/// The largest distance of all, mm.
double envelope_error(const TriMesh& boundary, const TriMesh& surface);

}  // namespace coxa::meshing
