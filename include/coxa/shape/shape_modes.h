#pragma once

#include <coxa/shape/atlas.h>

#include <vector>

namespace coxa::shape {

/// Shapes brought to one pose and size.
struct AlignedShapes {
  std::vector<Points> shapes;  ///< each V×3, in the pose and size of the mean, mm
  Points mean;                 ///< V×3, mm; pose and size are the average of the examples'
};

/// Generalised Procrustes analysis with similarities.
/// @param shapes  at least one, corresponding rows, mm
/// @param weights V, >= 0: how much each vertex counts for pose and size; empty: all alike
AlignedShapes align_shapes(const std::vector<Points>& shapes, const VecX& weights = {});

/// Principal components of aligned shapes.
/// @param variance_share in (0, 1]: as many modes as explain this share, fewer than the shapes
/// @note a single shape has no mode
ShapeModes principal_modes(const AlignedShapes& aligned, double variance_share);

/// How well shapes are described by modes of the others: each example is left out in turn, the
/// modes (all of them) of the rest are fitted to it.
/// @returns per example, root mean square distance of corresponding vertices, mm; empty for fewer
/// than
///          three
std::vector<double> leave_one_out_errors(const AlignedShapes& aligned);

/// mean + sum of coefficient · deviation · mode.
/// @param coefficients k or fewer, in standard deviations
Points shape_from(const Points& mean, const ShapeModes& modes, const VecX& coefficients);

}  // namespace coxa::shape
