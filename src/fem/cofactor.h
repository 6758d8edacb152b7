#pragma once

#include <coxa/core/types.h>

#include <Eigen/Geometry>

namespace coxa::fem {

/// dJ/dF, J the determinant of F.
inline Mat3 cofactor(const Mat3& F) {
  Mat3 C;
  C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return C;
}

}  // namespace coxa::fem
