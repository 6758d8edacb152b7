#include <coxa/fem/material.h>
#include <coxa/geom/cross_matrix.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "lame_check.h"
#include "lanes.h"
#include "mode_tensors.h"
#include "point_blocks.h"
#include "polar_rotation.h"
#include "principal_material.h"

namespace coxa::fem {
namespace {

/// A without its negative eigenvalues; the minors tell the two cases where nothing is to be done.
Mat3 positive_part(const Mat3& A) {
  const double minor = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0), determinant = A.determinant();
  if (minor > 0.0 && A(0, 0) > 0.0 && determinant > 0.0) return A;
  if (minor > 0.0 && A(0, 0) < 0.0 && determinant < 0.0) return Mat3::Zero();
  return tensile_part(A);
}

class Corotational : public PrincipalMaterial {
 public:
  explicit Corotational(const Lame& lame) : lame_(lame) { check(lame); }

  // the rotation is all that is needed, which is cheaper than the singular values
  double energy_density(const Mat3& F) const override {
    Mat3 P;
    return energy_with_piola(F, P);
  }
  Mat3 first_piola(const Mat3& F) const override {
    Mat3 P;
    energy_with_piola(F, P);
    return P;
  }
  double energy_with_piola(const Mat3& F, Mat3& P) const override {
    const auto R = polar_rotation(F);
    if (!R) {
      P = PrincipalMaterial::first_piola(F);
      return PrincipalMaterial::energy_density(F);
    }
    const Mat3 change = F - *R;
    const double sum = R->cwiseProduct(change).sum();
    P = 2.0 * lame_.mu * change + lame_.lambda * sum * *R;
    return lame_.mu * change.squaredNorm() + 0.5 * lame_.lambda * sum * sum;
  }

  void energies_with_piolas(const LaneMat3& F, LaneMat3& P, double* energy) const override {
    LaneMat3 R;
    const unsigned flat = polar_rotations(F, R);
    corotational_response(lame_, F, R, P, energy);
    for (int lane = 0; flat != 0 && lane < kLanes; ++lane) {
      if ((flat >> lane & 1U) == 0) continue;
      const Mat3 own = matrix_of(F, lane);
      set_matrix(P, lane, PrincipalMaterial::first_piola(own));
      energy[lane] = PrincipalMaterial::energy_density(own);
    }
  }

  void energies_with_known_rotations(const LaneMat3& F, const LaneMat3& R, LaneMat3& P,
                                     double* energy) const override {
    corotational_response(lame_, F, R, P, energy);
  }

  // dP = 2 mu dF + lambda (R : dF) R + turning dR, where for dF = d r_b
  // dR r_a = [q_a]x G [q_b]x^T d with q = R r, G = (tr(V) I - V)^-1 and F = V R. With
  // [a]x [b]x^T = (a.b) I - b a^T the linear law in turned axes is split off; what is left,
  // [q_a]x N [q_b]x^T, holds the only eigenvalues that can be negative: those of N.
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    const auto R = polar_rotation(F);
    if (!R) return PrincipalMaterial::add_blocks(F, kind, factor, r, blocks);
    const Mat3 V = F * R->transpose();
    const double turning = lame_.lambda * (V.trace() - 3.0) - 2.0 * lame_.mu;
    const Mat3 G = (V.trace() * Mat3::Identity() - 0.5 * (V + V.transpose())).inverse();
    Mat3 N = turning * G + lame_.mu * Mat3::Identity();
    if (kind == Tangent::positive) N = positive_part(N);
    const bool linear = N.isZero(0.0);
    Vec3 q[10];
    for (std::size_t a = 0; a < r.size(); ++a) q[a] = *R * r[a];
    add_pair_blocks(
        static_cast<int>(r.size()),
        [&](int a, int b) {
          Mat3 K = lame_.lambda * q[a] * q[b].transpose() + lame_.mu * q[b] * q[a].transpose();
          K.diagonal().array() += lame_.mu * q[a].dot(q[b]);
          if (!linear) K -= cross_matrix(q[a]) * N * cross_matrix(q[b]);
          return Mat3(factor * K);
        },
        blocks);
  }

 private:
  PrincipalResponse respond(const Vec3& s) const override {
    const Vec3 e = s - Vec3::Ones();
    const double sum = e.sum();
    return {lame_.mu * e.squaredNorm() + 0.5 * lame_.lambda * sum * sum,
            2.0 * lame_.mu * e + lame_.lambda * sum * Vec3::Ones(),
            2.0 * lame_.mu * Mat3::Identity() + lame_.lambda * Mat3::Ones()};
  }
  Lame lame_;
};

}  // namespace

std::unique_ptr<Material> make_corotational(const Lame& lame) {
  return std::make_unique<Corotational>(lame);
}

}  // namespace coxa::fem
