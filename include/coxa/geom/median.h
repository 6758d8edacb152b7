#pragma once

#include <coxa/core/types.h>

#include <algorithm>
#include <vector>

namespace coxa {

/// The middle value, of an even number the upper of the two. @param values at least one, no NaN
inline double median(VecX values) {
  double* const middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}
inline double median(const std::vector<double>& values) {
  return median(VecX(Eigen::Map<const VecX>(values.data(), static_cast<Index>(values.size()))));
}

}  // namespace coxa
