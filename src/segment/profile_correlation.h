#pragma once

#include <coxa/core/types.h>

namespace coxa::segment {

/// A reference profile ready for correlation: weighted mean 0, weighted variance 1.
struct ProfileReference {
  VecX weight;  ///< sums to 1
  VecX value;
  double slope = 0;  ///< at the border, share of the profile's range, in [-1, 1]
  bool informative = false;
};

/// @param n_inside  samples before the border
/// @param step      mm, from sample to sample
/// @param window    mm, Gaussian weight of a sample by its distance from the border
ProfileReference make_reference(const VecX& profile, Index n_inside, double step, double window);

/// Correlation of the reference with every stretch of its length of the line, the first at sample
/// 0; NaN where too little of it is in the image.
/// @param line  samples of an image, NaN outside of it
/// @param flat  standard deviation below which samples count as flat
VecX correlations(const ProfileReference& reference, const VecX& line, double flat);

}  // namespace coxa::segment
