#pragma once

#include <coxa/core/types.h>

#include <optional>

namespace coxa::fem {

/// The rotation R of F = R U with U symmetric and positive definite; nullopt where F is inverted or
/// so nearly singular that its rotation is better taken from its singular values.
/// Source: Higham 1986, Newton's iteration for the polar decomposition.
std::optional<Mat3> polar_rotation(const Mat3& F);

}  // namespace coxa::fem
