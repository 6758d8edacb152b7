#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// Smooth map of space that takes landmarks to landmarks: x -> A x + t + sum w_i |x - p_i| (3-D
/// biharmonic).
///
/// Source: Bookstein 1989, kernel U(r) = r for three dimensions.
class ThinPlateSpline {
 public:
  /// @param from, to    n×3, n >= 4 not coplanar, mm; rows correspond
  /// @param smoothness  >= 0, mm; 0 interpolates, larger values let noisy landmarks be missed
  /// @throws Error bad_input if fewer than four landmarks, coplanar, or two coincide
  ThinPlateSpline(const Points& from, const Points& to, double smoothness = 0.0);
  Vec3 operator()(const Vec3& x) const;
  Points operator()(const Points& x) const;

 private:
  Points from_;
  MatX weights_;  ///< (n+4)×3
};

}  // namespace coxa
