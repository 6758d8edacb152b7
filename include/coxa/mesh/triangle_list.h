#pragma once

#include <coxa/core/types.h>

#include <array>
#include <vector>

namespace coxa {

/// M×3 of triangles that were listed one by one.
inline Triangles triangles_from(const std::vector<std::array<Index, 3>>& list) {
  Triangles triangles(static_cast<Index>(list.size()), 3);
  for (std::size_t t = 0; t < list.size(); ++t)
    triangles.row(static_cast<Index>(t)) << list[t][0], list[t][1], list[t][2];
  return triangles;
}

}  // namespace coxa
