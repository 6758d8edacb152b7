#pragma once

#include <coxa/mesh/tri_mesh.h>

namespace coxa {

/// The mesh mirrored at x = 0, its triangles turned so that they still look outward: a left hip as
/// a right one, and back.
inline TriMesh mirrored(TriMesh mesh) {
  mesh.points.col(0) *= -1.0;
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

}  // namespace coxa
