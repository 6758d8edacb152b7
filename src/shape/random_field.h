#pragma once

#include <coxa/core/rng.h>
#include <coxa/core/types.h>

#include <vector>

namespace coxa::shape {

/// Smooth random displacement of space with Gaussian correlation exp(-d² / 2 length²).
class RandomField {
 public:
  /// @param rms mm, root mean square length of the displacement   @param length mm, > 0
  RandomField(double rms, double length, Rng& rng);
  Vec3 operator()(const Vec3& p) const;

 private:
  struct Wave {
    Vec3 frequency, amplitude;
    double phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace coxa::shape
