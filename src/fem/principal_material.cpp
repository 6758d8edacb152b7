#include "principal_material.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace coxa::fem {
namespace {

// stretches closer than this share the limit of the difference quotient: there its error is near
// 1e-10
constexpr double kEqualStretches = 1e-5;
// smallest sum of two stretches that is divided by; less occurs only where F is inverted
constexpr double kSmallestSum = 1e-4;

/// The symmetric matrix with its negative eigenvalues set to zero.
Mat3 positive_part(const Mat3& A) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(A);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
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
  const PrincipalResponse r = respond(svd.stretch);

  // the tangent in the frame where F is diagonal (Smith, de Goes and Kim 2019)
  Mat9 principal = Mat9::Zero();
  const Mat3 diagonal = kind == Tangent::positive ? positive_part(r.stiffness) : r.stiffness;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) principal(4 * i, 4 * j) = diagonal(i, j);
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) {
      PairStiffness pair = pair_stiffness(r, svd.stretch, i, j);
      if (kind == Tangent::positive)
        pair = {std::max(0.0, pair.stretching), std::max(0.0, pair.turning)};
      const int ij = i + 3 * j, ji = j + 3 * i;
      principal(ij, ij) = principal(ji, ji) = 0.5 * (pair.stretching + pair.turning);
      principal(ij, ji) = principal(ji, ij) = 0.5 * (pair.stretching - pair.turning);
    }

  Mat9 turn;  // vec(U X V^T) = turn vec(X)
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) turn.block<3, 3>(3 * k, 3 * l) = svd.V(k, l) * svd.U;
  return turn * principal * turn.transpose();
}

}  // namespace coxa::fem
