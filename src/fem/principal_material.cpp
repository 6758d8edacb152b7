#include "principal_material.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "mode_tensors.h"
#include "point_blocks.h"

namespace coxa::fem {
namespace {

// stretches closer than this share the limit of the difference quotient: there its error is near
// 1e-10
constexpr double kEqualStretches = 1e-5;
// smallest sum of two stretches that is divided by; less occurs only where F is inverted
constexpr double kSmallestSum = 1e-4;

/// The symmetric matrix with its negative eigenvalues set to zero.
Mat3 positive_part(const Mat3& A) {
  // most are positive definite, which the leading minors tell
  const double minor = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  if (A(0, 0) > 0.0 && minor > 0.0 && A.determinant() > 0.0) return A;
  return tensile_part(A);
}

/// dP in the principal frame for changes dF of the off-diagonal pair (i, j): `stretching` for the
/// symmetric part of the pair, `turning` for the skew part.
struct PairStiffness {
  double stretching, turning;
};

PairStiffness pair_stiffness(const PrincipalResponse& r, const Vec3& s, int i, int j) {
  const double gap = s[i] - s[j];
  const double stretching = std::abs(gap) > kEqualStretches
                                ? (r.stress[i] - r.stress[j]) / gap
                                : 0.5 * (r.stiffness(i, i) + r.stiffness(j, j)) - r.stiffness(i, j);
  const double sum = s[i] + s[j];
  const double turning = (r.stress[i] + r.stress[j]) /
                         (std::abs(sum) > kSmallestSum ? sum : std::copysign(kSmallestSum, sum));
  return {stretching, turning};
}

/// The tangent in the frame where F is diagonal (Smith, de Goes and Kim 2019): dP_ii = diagonal(i,
/// j) dF_jj and dP_ij = same(i, j) dF_ij + swapped(i, j) dF_ji.
struct PrincipalTangent {
  Mat3 diagonal, same, swapped;
};

PrincipalTangent principal_tangent(const PrincipalResponse& r, const Vec3& stretch, Tangent kind) {
  PrincipalTangent t;
  t.diagonal = kind == Tangent::positive ? positive_part(r.stiffness) : r.stiffness;
  t.same.setZero();
  t.swapped.setZero();
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) {
      PairStiffness pair = pair_stiffness(r, stretch, i, j);
      if (kind == Tangent::positive)
        pair = {std::max(0.0, pair.stretching), std::max(0.0, pair.turning)};
      t.same(i, j) = t.same(j, i) = 0.5 * (pair.stretching + pair.turning);
      t.swapped(i, j) = t.swapped(j, i) = 0.5 * (pair.stretching - pair.turning);
    }
  return t;
}

}  // namespace

double PrincipalMaterial::energy_density(const Mat3& F) const {
  return respond(signed_svd(F).stretch).energy;
}

Mat3 PrincipalMaterial::first_piola(const Mat3& F) const {
  const SignedSvd svd = signed_svd(F);
  return svd.U * respond(svd.stretch).stress.asDiagonal() * svd.V.transpose();
}

Mat9 PrincipalMaterial::tangent(const Mat3& F, Tangent kind) const {
  const SignedSvd svd = signed_svd(F);
  const PrincipalTangent t = principal_tangent(respond(svd.stretch), svd.stretch, kind);
  Mat9 principal = Mat9::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      principal(4 * i, 4 * j) = t.diagonal(i, j);
      if (i == j) continue;
      principal(i + 3 * j, i + 3 * j) = t.same(i, j);
      principal(i + 3 * j, j + 3 * i) = t.swapped(i, j);
    }
  Mat9 turn;  // vec(U X V^T) = turn vec(X)
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) turn.block<3, 3>(3 * k, 3 * l) = svd.V(k, l) * svd.U;
  return turn * principal * turn.transpose();
}

void PrincipalMaterial::add_blocks(const Mat3& F, Tangent kind, double factor,
                                   std::span<const Vec3> r, Mat3* blocks) const {
  const SignedSvd svd = signed_svd(F);
  const PrincipalTangent t = principal_tangent(respond(svd.stretch), svd.stretch, kind);
  Vec3 turned[10];  // the gradients in the principal frame
  for (std::size_t a = 0; a < r.size(); ++a) turned[a] = svd.V.transpose() * r[a];
  add_pair_blocks(
      static_cast<int>(r.size()),
      [&](int a, int b) {
        const Vec3 &ra = turned[a], &rb = turned[b];
        // t.same has no diagonal, so the products below leave out i = j by themselves
        Mat3 K = t.diagonal.cwiseProduct(ra * rb.transpose()) +
                 t.swapped.cwiseProduct(rb * ra.transpose());
        K.diagonal() += t.same * ra.cwiseProduct(rb);
        return Mat3(factor * (svd.U * K * svd.U.transpose()));
      },
      blocks);
}

}  // namespace coxa::fem
