#pragma once

#include <coxa/core/types.h>
#include <coxa/shape/atlas.h>

namespace coxa::segment {

/// Smooth deformations that the examples do not show: a Gaussian process over a mean shape, as a
/// matrix of modes.
struct SmoothModes {
  /// V×m, mm: how far one standard deviation of mode j moves vertex v, along x, y or z alike
  MatX moves;
};

struct SmoothOptions {
  double deviation = 1.0;  ///< mm, >= 0: of every coordinate, at every vertex
  double length = 30.0;    ///< mm, > 0: over which neighbours move alike
};

/// Modes whose sum, with independent standard normal coefficients, has about the covariance
/// deviation² exp(-d² / 2 length²) between vertices at distance d.
///
/// Nyström approximation from points spread over the surface.
/// @param points V×3, mm
/// Source: Lüthi et al. 2018, Gaussian process morphable models
SmoothModes smooth_modes(const Points& points, const SmoothOptions& options);

/// The modes of both, which are independent of each other.
SmoothModes joined(const SmoothModes& a, const SmoothModes& b);

}  // namespace coxa::segment
