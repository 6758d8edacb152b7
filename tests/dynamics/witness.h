#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/dynamics/system.h>

#include <cmath>

namespace coxa::dynamics::test {

/// A as a dense matrix.
inline MatX dense(const solve::BlockMatrix& A) {
  MatX result = MatX::Zero(3 * A.n(), 3 * A.n());
  for (Index i = 0; i < A.n(); ++i)
    for (auto s = A.row_start()[static_cast<std::size_t>(i)];
         s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
      result.block<3, 3>(3 * i, 3 * A.columns()[static_cast<std::size_t>(s)]) =
          A.blocks()[static_cast<std::size_t>(s)];
  return result;
}

/// -df/dx as the force gives it.
inline MatX given_stiffness(const Force& force, const VecX& x, const VecX& v) {
  solve::BlockMatrix A(static_cast<Index>(x.size() / 3), force.pattern());
  force.add_jacobian(x, v, 1.0, 0.0, A);
  return dense(A);
}
/// -df/dv as the force gives it.
inline MatX given_damping(const Force& force, const VecX& x, const VecX& v) {
  solve::BlockMatrix A(static_cast<Index>(x.size() / 3), force.pattern());
  force.add_jacobian(x, v, 0.0, 1.0, A);
  return dense(A);
}
inline VecX force_at(const Force& force, const VecX& x, const VecX& v) {
  VecX f = VecX::Zero(x.size());
  force.add_force(x, v, f);
  return f;
}
/// -df/dx by central differences of step h.
inline MatX numeric_stiffness(const Force& force, const VecX& x, const VecX& v, double h = 1e-6) {
  MatX K(x.size(), x.size());
  VecX moved = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    moved[k] = x[k] + h;
    const VecX above = force_at(force, moved, v);
    moved[k] = x[k] - h;
    K.col(k) = -(above - force_at(force, moved, v)) / (2.0 * h);
    moved[k] = x[k];
  }
  return K;
}
/// -df/dv by central differences of step h.
inline MatX numeric_damping(const Force& force, const VecX& x, const VecX& v, double h = 1e-6) {
  MatX D(x.size(), x.size());
  VecX moved = v;
  for (Eigen::Index k = 0; k < v.size(); ++k) {
    moved[k] = v[k] + h;
    const VecX above = force_at(force, x, moved);
    moved[k] = v[k] - h;
    D.col(k) = -(above - force_at(force, x, moved)) / (2.0 * h);
    moved[k] = v[k];
  }
  return D;
}
/// Minus the gradient of the energy by central differences of step h.
inline VecX numeric_force(const Force& force, const VecX& x, double h = 1e-6) {
  VecX f(x.size()), moved = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    moved[k] = x[k] + h;
    const double above = force.energy(moved);
    moved[k] = x[k] - h;
    f[k] = -(above - force.energy(moved)) / (2.0 * h);
    moved[k] = x[k];
  }
  return f;
}

}  // namespace coxa::dynamics::test
