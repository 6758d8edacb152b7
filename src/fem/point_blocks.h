#pragma once

#include <coxa/fem/material.h>

#include <span>

#include "scatter.h"

namespace coxa::fem {

/// Calls block(a, b) for each pair a <= b of an element's nodes at one point and adds the result to
/// its place.
///
/// The gradients of the shape functions sum to zero, so that with four nodes six blocks give the
/// other four.
template <class Block>
void add_pair_blocks(int n, const Block& block, Mat3* blocks) {
  if (n != 4) {
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b) blocks[Scatter::block_number(n, a, b)] += block(a, b);
    return;
  }
  const Mat3 K11 = block(1, 1), K12 = block(1, 2), K13 = block(1, 3);
  const Mat3 K22 = block(2, 2), K23 = block(2, 3), K33 = block(3, 3);
  const Mat3 K01 = -(K11 + K12.transpose() + K13.transpose());
  const Mat3 K02 = -(K12 + K22 + K23.transpose());
  const Mat3 K03 = -(K13 + K23 + K33);
  const Mat3* const all[10] = {nullptr, &K01, &K02, &K03, &K11, &K12, &K13, &K22, &K23, &K33};
  blocks[0] -= K01.transpose() + K02.transpose() + K03.transpose();
  for (int k = 1; k < 10; ++k) blocks[k] += *all[k];
}

/// Adds factor * r_a : C : r_b.
inline void add_tangent_blocks(const Mat9& C, double factor, std::span<const Vec3> r,
                               Mat3* blocks) {
  const int n = static_cast<int>(r.size());
  // C contracted with each node's gradient: three 3x3 parts, one for each column of F
  Eigen::Matrix<double, 9, 3> D[10];
  for (int b = 0; b < n; ++b) {
    const Vec3 rb = factor * r[static_cast<std::size_t>(b)];
    D[b] = C.leftCols<3>() * rb[0] + C.middleCols<3>(3) * rb[1] + C.rightCols<3>() * rb[2];
  }
  add_pair_blocks(
      n,
      [&](int a, int b) {
        const Vec3& ra = r[static_cast<std::size_t>(a)];
        return Mat3(ra[0] * D[b].topRows<3>() + ra[1] * D[b].middleRows<3>(3) +
                    ra[2] * D[b].bottomRows<3>());
      },
      blocks);
}

}  // namespace coxa::fem
