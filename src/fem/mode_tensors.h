#pragma once

#include <coxa/fem/curve_material.h>

#include <Eigen/Eigenvalues>

namespace coxa::fem {

/// The tensor M with M : E = direction . (E_uu, E_vv, E_ww, 2 E_uv, 2 E_vw, 2 E_uw).
inline Mat3 mode_tensor(const Vec6& c) {
  Mat3 M;
  M << c[0], c[3], c[5], c[3], c[1], c[4], c[5], c[4], c[2];
  return M;
}

/// Adds dP = dF S to a tangent.
inline void add_geometric(const Mat3& S, Mat9& C) {
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) C.block<3, 3>(3 * k, 3 * l).diagonal().array() += S(k, l);
}

/// S without its negative eigenvalues.
inline Mat3 tensile_part(const Mat3& S) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(S);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

}  // namespace coxa::fem
