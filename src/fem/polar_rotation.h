#pragma once

#include <coxa/core/types.h>

#include <optional>

namespace coxa::fem {

// where the sums of two stretches multiply to less than this share of what equal stretches of the
// same size would give, the rotation is left to the singular values
inline constexpr double kFlattest = 0.02;
// Newton's iteration for the sum of the stretches: a step so small leaves an error of its square
inline constexpr double kLastStep = 1e-8;
inline constexpr int kMaxSteps = 40;

/// The rotation R of F = R U with U symmetric and at most its smallest stretch negative: the
/// slope of the sum of the stretches by F, in closed form from the invariants of F.
///
/// @returns nullopt where two stretches nearly cancel, so that R is hardly defined
/// Source: the sum of stretches as the largest root of a quartic, Horn 1987 (absolute orientation)
/// and Hoger and Carlson 1984 (stretch from invariants); R as its derivative is ours.
std::optional<Mat3> polar_rotation(const Mat3& F);

}  // namespace coxa::fem
