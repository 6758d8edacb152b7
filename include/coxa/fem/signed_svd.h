#pragma once

#include <coxa/core/types.h>

namespace coxa::fem {

/// F = U diag(stretch) V^T with rotations U and V: the last stretch is negative where F is
/// inverted.
struct SignedSvd {
  Mat3 U, V;
  Vec3 stretch;  ///< descending in magnitude
};

/// One-sided Jacobi, to rounding also for equal or vanishing stretches.
/// Source: Hestenes 1958; signs as in Irving et al. 2004.
SignedSvd signed_svd(const Mat3& F);

}  // namespace coxa::fem
