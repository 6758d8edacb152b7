#pragma once

#include <coxa/core/types.h>

#include <cstdint>

namespace coxa {

/// Random numbers from an explicit seed: the same sequence on every machine (PCG32; normals by
/// Box-Muller).
class Rng {
 public:
  explicit Rng(std::uint64_t seed);
  std::uint32_t bits();  ///< uniform on [0, 2^32)
  double uniform();      ///< uniform on [0, 1)
  double uniform(double low, double high);
  double normal();       ///< mean 0, variance 1
  Vec3 normal3();        ///< three independent normals
  Index below(Index n);  ///< uniform on {0, …, n-1}, n > 0

 private:
  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace coxa
