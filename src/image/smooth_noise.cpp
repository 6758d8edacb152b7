#include "smooth_noise.h"

#include <cmath>

namespace coxa {
namespace {

/// Mixes lattice coordinates and seed to 64 random-looking bits (splitmix64 finaliser).
std::uint64_t hash(std::int64_t i, std::int64_t j, std::int64_t k, std::uint64_t seed) {
  std::uint64_t x = seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(i) +
                    0xc2b2ae3d27d4eb4fULL * static_cast<std::uint64_t>(j) +
                    0x165667b19e3779f9ULL * static_cast<std::uint64_t>(k);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Uniform on [-1, 1).
double lattice_value(std::int64_t i, std::int64_t j, std::int64_t k, std::uint64_t seed) {
  return static_cast<double>(hash(i, j, k, seed) >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace

double smooth_noise(const Vec3& p, double wavelength, std::uint64_t seed) {
  std::int64_t cell[3];
  double w[3];
  for (int a = 0; a < 3; ++a) {
    const double x = p[a] / wavelength, floor = std::floor(x), t = x - floor;
    cell[a] = static_cast<std::int64_t>(floor);
    w[a] = t * t * (3.0 - 2.0 * t);
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int di = corner & 1, dj = corner >> 1 & 1, dk = corner >> 2;
    sum += (di ? w[0] : 1.0 - w[0]) * (dj ? w[1] : 1.0 - w[1]) * (dk ? w[2] : 1.0 - w[2]) *
           lattice_value(cell[0] + di, cell[1] + dj, cell[2] + dk, seed);
  }
  // uniform on [-1, 1) has variance 1/3; the mean square of the weights over a cell is (26/35)^3
  return sum / std::sqrt(1.0 / 3.0 * 0.41);
}

}  // namespace coxa
