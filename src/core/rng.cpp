#include <coxa/core/rng.h>

#include <coxa/core/error.h>

#include <cmath>

namespace coxa {
namespace {
// PCG32 (O'Neill 2014): multiplier and stream increment
constexpr std::uint64_t kMultiplier = 6364136223846793005ULL;
constexpr std::uint64_t kIncrement = 1442695040888963407ULL;
}  // namespace

Rng::Rng(std::uint64_t seed) : state_(seed + kIncrement) { bits(); }

std::uint32_t Rng::bits() {
  const std::uint64_t old = state_;
  state_ = old * kMultiplier + kIncrement;
  const auto xorshifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotation = static_cast<std::uint32_t>(old >> 59U);
  return (xorshifted >> rotation) | (xorshifted << ((32U - rotation) & 31U));
}

double Rng::uniform() {
  const std::uint64_t high = bits() >> 5U, low = bits() >> 6U;
  return (static_cast<double>(high) * 67108864.0 + static_cast<double>(low)) / 9007199254740992.0;
}

double Rng::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Rng::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform())), angle = 2.0 * kPi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Vec3 Rng::normal3() {
  const double x = normal(), y = normal(), z = normal();
  return {x, y, z};
}

Index Rng::below(Index n) {
  COXA_ASSERT(n > 0);
  return static_cast<Index>(uniform() * n);
}

}  // namespace coxa
