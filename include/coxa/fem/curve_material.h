#pragma once

#include <coxa/fem/curve.h>
#include <coxa/fem/material.h>

#include <array>
#include <memory>
#include <vector>

namespace coxa::fem {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// One way of straining, and the stress it meets: a linear combination of the six modes of the
/// Green strain along the material axes (E_uu, E_vv, E_ww, 2 E_uv, 2 E_vw, 2 E_uw).
struct StrainMode {
  Vec6 direction;  ///< coefficients of the six modes
  Curve stress;    ///< MPa, as a function of direction . strain
};

/// The three tensile and three shear modes, in the order of `StrainMode::direction`.
std::vector<StrainMode> six_modes(const std::array<Curve, 6>& curves);
/// Resistance to the sum of the tensile strains.
StrainMode volume_mode(Curve stress);
/// The modes of S = lambda tr(E) + 2 mu E.
std::vector<StrainMode> linear_modes(const Lame& lame);

/// The unrotated mode: energy density is the sum of the curves' integrals over their modes, so that
/// S is the sum of stress_k(direction_k . strain) direction_k. Anisotropic: ElasticOptions::axes
/// turns u, v, w element by element. Source: Volino, Magnenat-Thalmann and Faure 2009, here in
/// three dimensions.
std::unique_ptr<Material> make_curve_material(std::vector<StrainMode> modes);

/// The rotated mode with curves: along each eigendirection of the strain stress(l - 1), plus
/// volume(sum of l - 1), where l are the principal stretches. Resists compression and inversion as
/// its curves do.
std::unique_ptr<Material> make_rotated_curve_material(Curve stress, Curve volume);

}  // namespace coxa::fem
