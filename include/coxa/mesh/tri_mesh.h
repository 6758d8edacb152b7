#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// Triangle surface: LPS mm, counter-clockwise seen from outside.
struct TriMesh {
  Points points;        ///< V×3
  Triangles triangles;  ///< T×3

  Index n_vertices() const { return static_cast<Index>(points.rows()); }
  Index n_triangles() const { return static_cast<Index>(triangles.rows()); }
  bool empty() const { return triangles.rows() == 0; }
};

}  // namespace coxa
