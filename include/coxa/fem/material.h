#pragma once

#include <coxa/core/types.h>

#include <memory>
#include <span>

namespace coxa::fem {

using Mat9 = Eigen::Matrix<double, 9, 9>;

/// Lamé's parameters, MPa.
struct Lame {
  double lambda = 0.0;
  double mu = 0.0;
};

/// Lamé's parameters of Young's modulus E, MPa, > 0, and Poisson's ratio nu in (-1, 0.5).
/// @throws Error bad_input if one is out of range
Lame lame_from(double E, double nu);

enum class Tangent {
  exact,    ///< the derivative, which may be indefinite
  positive  ///< a positive semidefinite stand-in, equal to the derivative where that is positive
};

struct LaneMat3;  ///< four matrices side by side, src/fem/lanes.h

/// A hyperelastic law: energy density as a function of the deformation gradient.
class Material {
 public:
  virtual ~Material() = default;
  /// N·mm/mm³, 0 at rest; infinite where the law forbids F.
  virtual double energy_density(const Mat3& F) const = 0;
  /// P = dW/dF, MPa.
  virtual Mat3 first_piola(const Mat3& F) const = 0;
  /// Both at once, which costs less for laws that need the same of F for either; returns the energy
  /// density and sets P, whatever it is where the energy is infinite.
  virtual double energy_with_piola(const Mat3& F, Mat3& P) const;
  /// Both for four deformation gradients at once; sets four energy densities. Laws that can work on
  /// them side by side do.
  virtual void energies_with_piolas(const LaneMat3& F, LaneMat3& P, double* energy) const;
  /// The same where the rotations R of F = R S are known.
  virtual void energies_with_known_rotations(const LaneMat3& F, const LaneMat3& R, LaneMat3& P,
                                             double* energy) const;
  /// dP/dF, 9×9 over the columns of F one after the other: entry (a + 3k, b + 3l) is dP_ak / dF_bl.
  virtual Mat9 tangent(const Mat3& F, Tangent kind) const = 0;
  /// Adds the blocks of an element's stiffness at one point: factor * r_a : tangent : r_b to block
  /// (a, b), a <= b, which stands at a n - a (a - 1)/2 + b - a of `blocks`. Laws with a shorter way
  /// than `tangent` take it.
  /// @param r  gradients of the n shape functions, 1/mm
  virtual void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                          Mat3* blocks) const;
};

/// sigma = F S F^T / J for a first Piola-Kirchhoff stress P at F; NaN where J = 0.
Mat3 cauchy_from(const Mat3& P, const Mat3& F);

/// S = lambda tr(E) + 2 mu E, the unrotated mode: exact for large rotations, collapses below
/// stretch 0.577.
std::unique_ptr<Material> make_st_venant_kirchhoff(const Lame& lame);
/// W = mu |S - I|^2 + lambda/2 tr(S - I)^2 with F = R S, the rotated mode: resists compression and
/// inversion.
std::unique_ptr<Material> make_corotational(const Lame& lame);
/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2; infinite for J <= 0.
std::unique_ptr<Material> make_neo_hookean(const Lame& lame);
/// Neo-Hookean law that stays finite under inversion. Source: Smith et al. 2018, eq. 14, its
/// parameters reset so that small strains follow `lame`.
std::unique_ptr<Material> make_stable_neo_hookean(const Lame& lame);
/// W = c1 (exp(c2 (I1 - 3)) - 1) - c1 c2/2 (I2 - 3) + bulk/2 (ln J)^2 on isochoric invariants;
/// shear modulus c1 c2.
/// @param c1 MPa   @param c2 no unit   @param bulk MPa, all > 0
std::unique_ptr<Material> make_veronda_westmann(double c1, double c2, double bulk);

/// How a porous solid locks once its fluid is out.
struct Compaction {
  double volume_ratio = 0.0;  ///< in (0, 1): J below which it resists
  double bulk = 0.0;          ///< MPa, > 0: pressure for a further change of J by one
};
/// A law with bulk/2 (J0 - J)^2 added below J0: elements that an edge squeezes flat lock instead of
/// turning inside out.
std::unique_ptr<Material> make_compacting(std::unique_ptr<Material> law,
                                          const Compaction& compaction);

}  // namespace coxa::fem
