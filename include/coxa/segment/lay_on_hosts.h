#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::segment {

/// A layer of cartilage and the bone it lies on.
struct LaidLayer {
  TriMesh* layer = nullptr;
  const TriMesh* host = nullptr;
  Index n_bone_side = 0;  ///< first triangles, on the host; triangle i + n_bone_side lies opposite
                          ///< triangle i; 0: not known
};

/// Lays finished layers on their hosts and keeps them out of each other.
///
/// What faces the host comes to lie on it. The other side keeps its height above the host, but not
/// more than the layer is thick there (a tip that floats is brought down), and where two layers
/// need more room than there is between their hosts less `gap` (mm), both give way in proportion to
/// their thickness. Last, triangles that still cut a host or another layer are pushed out of it.
/// @returns the greatest depth that is left, mm (part_bodies.h)
double lay_on_hosts(std::vector<LaidLayer>& layers, double gap);

}  // namespace coxa::segment
