#pragma once

#include <coxa/fem/material.h>
#include <coxa/fem/mean_dilatation.h>

#include <memory>

namespace coxa::fem {

/// What a law takes for the volume change of a point, written like a law whose energy density it
/// is: `first_piola` is its slope by F, `tangent` and `add_blocks` its curvature.
std::unique_ptr<const Material> make_volume_measure(Dilatation dilatation);

/// The law's resistance to the mean m of the measure over a patch, per reference volume.
struct VolumeResistance {
  double energy, slope, curvature;  ///< MPa: phi(m) and its derivatives by m
};
/// Infinite energy and slopes of no meaning where the law forbids m.
VolumeResistance volume_resistance(Dilatation dilatation, double lambda, double m);

/// Whether the curvature of the measure is positive semidefinite, so that only a positive slope
/// keeps the tangent so.
bool is_convex(Dilatation dilatation);

}  // namespace coxa::fem
