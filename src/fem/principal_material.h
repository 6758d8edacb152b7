#pragma once

#include <coxa/fem/material.h>
#include <coxa/fem/signed_svd.h>

namespace coxa::fem {

/// Energy density of an isotropic law at principal stretches, with its derivatives by them.
struct PrincipalResponse {
  double energy = 0.0;
  Vec3 stress = Vec3::Zero();     ///< dW/dstretch, MPa
  Mat3 stiffness = Mat3::Zero();  ///< its derivative
};

/// An isotropic law written in principal stretches; the last one is negative under inversion.
class PrincipalMaterial : public Material {
 public:
  double energy_density(const Mat3& F) const override;
  Mat3 first_piola(const Mat3& F) const override;
  Mat9 tangent(const Mat3& F, Tangent kind) const override;
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override;

 protected:
  /// Energy infinite and derivatives zero where the law forbids the stretches.
  virtual PrincipalResponse respond(const Vec3& stretch) const = 0;
};

}  // namespace coxa::fem
