#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// The matrix of v -> w x v.
inline Mat3 cross_matrix(const Vec3& w) {
  Mat3 M;
  M << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return M;
}

}  // namespace coxa
