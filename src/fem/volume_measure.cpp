#include "volume_measure.h"

#include <coxa/geom/cross_matrix.h>

#include <Eigen/LU>

#include <cmath>

#include "cofactor.h"
#include "lanes.h"
#include "point_blocks.h"
#include "polar_rotation.h"
#include "principal_material.h"

namespace coxa::fem {
namespace {

/// J = det F.
class VolumeRatio : public Material {
 public:
  double energy_density(const Mat3& F) const override { return F.determinant(); }
  Mat3 first_piola(const Mat3& F) const override { return cofactor(F); }
  Mat9 tangent(const Mat3& F, Tangent) const override {
    Mat9 T;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l)
        T.block<3, 3>(3 * k, 3 * l) = -cross_matrix(F * Vec3(Vec3::Unit(k).cross(Vec3::Unit(l))));
    return T;
  }
  void add_blocks(const Mat3& F, Tangent, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    // d2J / dx_a dx_b = -[F (r_a x r_b)]x
    add_pair_blocks(
        static_cast<int>(r.size()),
        [&](int a, int b) {
          const Vec3 &ra = r[static_cast<std::size_t>(a)], &rb = r[static_cast<std::size_t>(b)];
          return Mat3(-factor * cross_matrix(F * ra.cross(rb)));
        },
        blocks);
  }
};

/// Sum of the (signed) stretches; its slope is the rotation R of F = R S.
class StretchSum : public PrincipalMaterial {
 public:
  double energy_density(const Mat3& F) const override {
    const auto R = polar_rotation(F);
    return R ? R->cwiseProduct(F).sum() : PrincipalMaterial::energy_density(F);
  }
  Mat3 first_piola(const Mat3& F) const override {
    const auto R = polar_rotation(F);
    return R ? *R : PrincipalMaterial::first_piola(F);
  }
  double energy_with_piola(const Mat3& F, Mat3& P) const override {
    P = first_piola(F);
    return P.cwiseProduct(F).sum();
  }
  void energies_with_piolas(const LaneMat3& F, LaneMat3& P, double* energy) const override {
    if (polar_rotations(F, P) != 0) return Material::energies_with_piolas(F, P, energy);
    inner_products(P, F, energy);
  }
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    const auto R = polar_rotation(F);
    if (!R) return PrincipalMaterial::add_blocks(F, kind, factor, r, blocks);
    // dR r_a = [q_a]x G [q_b]x^T d for dF = d r_b, with q = R r, G = (tr(V) I - V)^-1 and F = V R
    const Mat3 V = F * R->transpose();
    const Mat3 G = (V.trace() * Mat3::Identity() - 0.5 * (V + V.transpose())).inverse();
    Vec3 q[10];
    for (std::size_t a = 0; a < r.size(); ++a) q[a] = *R * r[a];
    add_pair_blocks(
        static_cast<int>(r.size()),
        [&](int a, int b) { return Mat3(-factor * cross_matrix(q[a]) * G * cross_matrix(q[b])); },
        blocks);
  }

 private:
  PrincipalResponse respond(const Vec3& s) const override {
    return {s.sum(), Vec3::Ones(), Mat3::Zero()};
  }
};

/// tr(E), E Green strain.
class GreenTrace : public Material {
 public:
  double energy_density(const Mat3& F) const override { return 0.5 * (F.squaredNorm() - 3.0); }
  Mat3 first_piola(const Mat3& F) const override { return F; }
  Mat9 tangent(const Mat3&, Tangent) const override { return Mat9::Identity(); }
};

}  // namespace

std::unique_ptr<const Material> make_volume_measure(Dilatation dilatation) {
  switch (dilatation) {
    case Dilatation::stretch_sum:
      return std::make_unique<StretchSum>();
    case Dilatation::green_trace:
      return std::make_unique<GreenTrace>();
    case Dilatation::log_volume:
      break;
  }
  return std::make_unique<VolumeRatio>();
}

VolumeResistance volume_resistance(Dilatation dilatation, double lambda, double m) {
  if (dilatation != Dilatation::log_volume) {
    const double change = dilatation == Dilatation::stretch_sum ? m - 3.0 : m;
    return {0.5 * lambda * change * change, lambda * change, lambda};
  }
  if (!(m > 0.0)) return {kInfinity, kNaN, kNaN};
  const double log_m = std::log(m);
  return {0.5 * lambda * log_m * log_m, lambda * log_m / m, lambda * (1.0 - log_m) / (m * m)};
}

bool is_convex(Dilatation dilatation) { return dilatation != Dilatation::log_volume; }

}  // namespace coxa::fem
