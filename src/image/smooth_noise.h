#pragma once

#include <coxa/core/types.h>

#include <cstdint>

namespace coxa {

/// Smooth random field of mean 0 and standard deviation about 1: random values on a lattice with
/// cells of `wavelength` mm, joined by cubic smoothing weights. The same at p for the same seed.
double smooth_noise(const Vec3& p, double wavelength, std::uint64_t seed);

}  // namespace coxa
