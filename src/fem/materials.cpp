#include <coxa/core/error.h>
#include <coxa/fem/material.h>

#include <Eigen/LU>

#include <cmath>

#include "lame_check.h"
#include "mode_tensors.h"
#include "point_blocks.h"
#include "principal_material.h"

namespace coxa::fem {
namespace {

class StVenantKirchhoff : public Material {
 public:
  explicit StVenantKirchhoff(const Lame& lame) : lame_(lame) { check(lame); }

  double energy_density(const Mat3& F) const override {
    const Mat3 E = green_strain(F);
    return lame_.mu * E.squaredNorm() + 0.5 * lame_.lambda * E.trace() * E.trace();
  }
  Mat3 first_piola(const Mat3& F) const override { return F * second_piola(F); }
  Mat9 tangent(const Mat3& F, Tangent kind) const override {
    Mat3 S = second_piola(F);
    if (kind == Tangent::positive) S = tensile_part(S);
    // dP = dF S + lambda tr(F^T dF) F + mu (F F^T dF + F dF^T F)
    const Mat3 FFt = F * F.transpose();
    Mat9 C;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) {
        auto block = C.block<3, 3>(3 * k, 3 * l);
        block = lame_.lambda * F.col(k) * F.col(l).transpose() +
                lame_.mu * F.col(l) * F.col(k).transpose();
        block.diagonal().array() += S(k, l);
        if (k == l) block += lame_.mu * FFt;
      }
    return C;
  }
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    Mat3 S = second_piola(F);
    if (kind == Tangent::positive) S = tensile_part(S);
    const Mat3 FFt = F * F.transpose();
    const std::size_t n = r.size();
    Vec3 Fr[10], Sr[10];
    for (std::size_t a = 0; a < n; ++a) {
      Fr[a] = F * r[a];
      Sr[a] = S * r[a];
    }
    add_pair_blocks(
        static_cast<int>(n),
        [&](int a, int b) {
          const Vec3& ra = r[static_cast<std::size_t>(a)];
          const double overlap = ra.dot(r[static_cast<std::size_t>(b)]);
          Mat3 K = lame_.lambda * Fr[a] * Fr[b].transpose() +
                   lame_.mu * (Fr[b] * Fr[a].transpose() + overlap * FFt);
          K.diagonal().array() += ra.dot(Sr[b]);
          return Mat3(factor * K);
        },
        blocks);
  }

 private:
  static Mat3 green_strain(const Mat3& F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }
  Mat3 second_piola(const Mat3& F) const {
    const Mat3 E = green_strain(F);
    return 2.0 * lame_.mu * E + lame_.lambda * E.trace() * Mat3::Identity();
  }
  Lame lame_;
};

class NeoHookean : public PrincipalMaterial {
 public:
  explicit NeoHookean(const Lame& lame) : lame_(lame) { check(lame); }

  double energy_density(const Mat3& F) const override {
    const double J = F.determinant();
    if (!(J > 0.0)) return kInfinity;
    const double log_J = std::log(J);
    return 0.5 * lame_.mu * (F.squaredNorm() - 3.0) - lame_.mu * log_J +
           0.5 * lame_.lambda * log_J * log_J;
  }
  Mat3 first_piola(const Mat3& F) const override {
    const double J = F.determinant();
    if (!(J > 0.0)) return Mat3::Constant(kNaN);
    const Mat3 G = F.inverse().transpose();
    return lame_.mu * (F - G) + lame_.lambda * std::log(J) * G;
  }
  Mat9 tangent(const Mat3& F, Tangent kind) const override {
    const double J = F.determinant();
    if (kind == Tangent::positive || !(J > 0.0)) return PrincipalMaterial::tangent(F, kind);
    // dP = mu dF + (mu - lambda ln J) G dF^T G + lambda tr(G^T dF) G, with G = F^-T
    const Mat3 G = F.inverse().transpose();
    const double back = lame_.mu - lame_.lambda * std::log(J);
    Mat9 C;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l)
        C.block<3, 3>(3 * k, 3 * l) =
            lame_.lambda * G.col(k) * G.col(l).transpose() + back * G.col(l) * G.col(k).transpose();
    C.diagonal().array() += lame_.mu;
    return C;
  }
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    const double J = F.determinant();
    if (kind == Tangent::positive || !(J > 0.0))
      return PrincipalMaterial::add_blocks(F, kind, factor, r, blocks);
    const Mat3 G = F.inverse().transpose();
    const double back = lame_.mu - lame_.lambda * std::log(J);
    Vec3 Gr[10];
    for (std::size_t a = 0; a < r.size(); ++a) Gr[a] = G * r[a];
    add_pair_blocks(
        static_cast<int>(r.size()),
        [&](int a, int b) {
          Mat3 K = lame_.lambda * Gr[a] * Gr[b].transpose() + back * Gr[b] * Gr[a].transpose();
          K.diagonal().array() +=
              lame_.mu * r[static_cast<std::size_t>(a)].dot(r[static_cast<std::size_t>(b)]);
          return Mat3(factor * K);
        },
        blocks);
  }

 private:
  PrincipalResponse respond(const Vec3& s) const override {
    const double J = s.prod();
    if (!(J > 0.0)) return {kInfinity, Vec3::Zero(), Mat3::Zero()};
    const double log_J = std::log(J);
    const Vec3 inverse = s.cwiseInverse();
    PrincipalResponse r;
    r.energy = 0.5 * lame_.mu * (s.squaredNorm() - 3.0) - lame_.mu * log_J +
               0.5 * lame_.lambda * log_J * log_J;
    r.stress = lame_.mu * (s - inverse) + lame_.lambda * log_J * inverse;
    r.stiffness = lame_.lambda * inverse * inverse.transpose();
    r.stiffness.diagonal().array() +=
        lame_.mu + (lame_.mu - lame_.lambda * log_J) * inverse.array().square();
    return r;
  }
  Lame lame_;
};

/// Derivatives of J by the stretches without division: they stay right where a stretch vanishes.
Vec3 volume_gradient(const Vec3& s) { return {s[1] * s[2], s[2] * s[0], s[0] * s[1]}; }
Mat3 volume_hessian(const Vec3& s) {
  Mat3 H;
  H << 0, s[2], s[1], s[2], 0, s[0], s[1], s[0], 0;
  return H;
}

class StableNeoHookean : public PrincipalMaterial {
 public:
  explicit StableNeoHookean(const Lame& lame)
      : mu_(4.0 / 3.0 * lame.mu), lambda_(lame.lambda + 5.0 / 6.0 * lame.mu) {
    check(lame);
    require(lambda_ > 0.0, "the stable neo-Hookean law needs lambda > -5/6 mu, got lambda ",
            lame.lambda, ", mu ", lame.mu, " MPa");
    alpha_ = 1.0 + 0.75 * mu_ / lambda_;
    at_rest_ = 0.5 * lambda_ * (1.0 - alpha_) * (1.0 - alpha_) - 0.5 * mu_ * std::log(4.0);
  }

 private:
  PrincipalResponse respond(const Vec3& s) const override {
    const double I1 = s.squaredNorm(), over = s.prod() - alpha_, shrink = 1.0 / (I1 + 1.0);
    const Vec3 dJ = volume_gradient(s);
    PrincipalResponse r;
    r.energy = 0.5 * mu_ * (I1 - 3.0) + 0.5 * lambda_ * over * over -
               0.5 * mu_ * std::log(I1 + 1.0) - at_rest_;
    r.stress = mu_ * (1.0 - shrink) * s + lambda_ * over * dJ;
    r.stiffness = 2.0 * mu_ * shrink * shrink * s * s.transpose() + lambda_ * dJ * dJ.transpose() +
                  lambda_ * over * volume_hessian(s);
    r.stiffness.diagonal().array() += mu_ * (1.0 - shrink);
    return r;
  }
  double mu_, lambda_, alpha_, at_rest_;
};

/// A function of the stretches with its first and second derivatives.
struct Invariant {
  double value;
  Vec3 gradient;
  Mat3 hessian;
};

/// J^power times the invariant.
Invariant scaled_by_volume(const Invariant& g, const Vec3& s, double power) {
  const double factor = std::pow(s.prod(), power);
  const Vec3 inverse = s.cwiseInverse();
  Invariant f;
  f.value = factor * g.value;
  f.gradient = factor * (g.gradient + power * g.value * inverse);
  f.hessian = g.hessian +
              power * (g.gradient * inverse.transpose() + inverse * g.gradient.transpose()) +
              power * power * g.value * inverse * inverse.transpose();
  f.hessian.diagonal().array() -= power * g.value * inverse.array().square();
  f.hessian *= factor;
  return f;
}

class VerondaWestmann : public PrincipalMaterial {
 public:
  VerondaWestmann(double c1, double c2, double bulk) : c1_(c1), c2_(c2), bulk_(bulk) {
    require(c1 > 0.0 && c2 > 0.0 && bulk > 0.0,
            "Veronda-Westmann needs positive c1, c2 and bulk, got ", c1, ", ", c2, ", ", bulk);
  }

 private:
  PrincipalResponse respond(const Vec3& s) const override {
    const double J = s.prod();
    if (!(J > 0.0)) return {kInfinity, Vec3::Zero(), Mat3::Zero()};
    const Vec3 square = s.cwiseAbs2();
    const double sum = square.sum();
    const Invariant first = scaled_by_volume({sum, 2.0 * s, 2.0 * Mat3::Identity()}, s, -2.0 / 3.0);
    Mat3 hessian2 = 4.0 * s * s.transpose();
    hessian2.diagonal() = 2.0 * (sum - square.array());
    const double second_value =
        square[0] * square[1] + square[1] * square[2] + square[2] * square[0];
    const Invariant second = scaled_by_volume(
        {second_value, 2.0 * s.array() * (sum - square.array()), hessian2}, s, -4.0 / 3.0);

    const double growth = std::exp(c2_ * (first.value - 3.0)), log_J = std::log(J);
    const Vec3 inverse = s.cwiseInverse();
    PrincipalResponse r;
    r.energy =
        c1_ * (growth - 1.0) - 0.5 * c1_ * c2_ * (second.value - 3.0) + 0.5 * bulk_ * log_J * log_J;
    r.stress =
        c1_ * c2_ * (growth * first.gradient - 0.5 * second.gradient) + bulk_ * log_J * inverse;
    r.stiffness =
        c1_ * c2_ *
            (growth * (first.hessian + c2_ * first.gradient * first.gradient.transpose()) -
             0.5 * second.hessian) +
        bulk_ * inverse * inverse.transpose();
    r.stiffness.diagonal().array() -= bulk_ * log_J * inverse.array().square();
    return r;
  }
  double c1_, c2_, bulk_;
};

}  // namespace

double Material::energy_with_piola(const Mat3& F, Mat3& P) const {
  P = first_piola(F);
  return energy_density(F);
}

void Material::add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                          Mat3* blocks) const {
  add_tangent_blocks(tangent(F, kind), factor, r, blocks);
}

Lame lame_from(double E, double nu) {
  require(E > 0.0, "Young's modulus must be positive, got ", E, " MPa");
  require(nu > -1.0 && nu < 0.5, "Poisson's ratio must be in (-1, 0.5), got ", nu);
  return {E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * E / (1.0 + nu)};
}

Mat3 cauchy_from(const Mat3& P, const Mat3& F) {
  const double J = F.determinant();
  return J != 0.0 ? Mat3(P * F.transpose() / J) : Mat3::Constant(kNaN);
}

std::unique_ptr<Material> make_st_venant_kirchhoff(const Lame& lame) {
  return std::make_unique<StVenantKirchhoff>(lame);
}
std::unique_ptr<Material> make_neo_hookean(const Lame& lame) {
  return std::make_unique<NeoHookean>(lame);
}
std::unique_ptr<Material> make_stable_neo_hookean(const Lame& lame) {
  return std::make_unique<StableNeoHookean>(lame);
}
std::unique_ptr<Material> make_veronda_westmann(double c1, double c2, double bulk) {
  return std::make_unique<VerondaWestmann>(c1, c2, bulk);
}

}  // namespace coxa::fem
