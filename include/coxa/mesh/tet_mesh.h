#pragma once

#include <coxa/core/types.h>

#include <vector>

namespace coxa {

/// What a boundary facet of a cartilage (or other layer) is.
enum class FacetTag : std::int8_t { untagged = 0, bone_side = 1, articular_side = 2, rim = 3 };

/// Tetrahedral mesh: mm, positive volumes.
struct TetMesh {
  Points points;  ///< N×3
  Tets tets;      ///< M×4
  /// Mid-edge nodes of ten-node elements, M×6 in VTK order (01 12 20 03 13 23); empty for four-node
  /// elements.
  Eigen::Matrix<Index, Eigen::Dynamic, 6, Eigen::RowMajor> mid_nodes;
  Triangles facets;                  ///< boundary, B×3, counter-clockwise from outside
  std::vector<FacetTag> facet_tags;  ///< B

  Index n_vertices() const { return static_cast<Index>(points.rows()); }
  Index n_tets() const { return static_cast<Index>(tets.rows()); }
};

}  // namespace coxa
