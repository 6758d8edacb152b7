#pragma once

#include <coxa/core/rng.h>
#include <coxa/solve/block_matrix.h>

#include <utility>
#include <vector>

namespace coxa::solve::test {

/// Symmetric positive definite matrix of a ring of n particles with chords, random blocks from
/// `seed`.
inline BlockMatrix ring_matrix(Index n, std::uint64_t seed = 1, double shift = 1.0) {
  std::vector<std::pair<Index, Index>> pairs;
  for (Index i = 0; i < n; ++i)
    for (const Index step : {Index{1}, Index{7}}) {
      pairs.emplace_back(i, (i + step) % n);
      pairs.emplace_back((i + step) % n, i);
    }
  BlockMatrix A(n, pairs);
  Rng rng(seed);
  for (Index i = 0; i < n; ++i)
    for (const Index step : {Index{1}, Index{7}}) {
      // the stiffness of a spring with an indefinite-free tensor B B^T
      const Index j = (i + step) % n;
      Mat3 B;
      for (int k = 0; k < 9; ++k) B(k) = rng.normal();
      const Mat3 stiffness = B * B.transpose();
      A.at(i, i) += stiffness;
      A.at(j, j) += stiffness;
      A.at(i, j) -= stiffness;
      A.at(j, i) -= stiffness;
    }
  for (Index i = 0; i < n; ++i) A.at(i, i) += shift * Mat3::Identity();
  return A;
}

inline VecX random_vector(Eigen::Index size, std::uint64_t seed) {
  Rng rng(seed);
  VecX values(size);
  for (double& value : values) value = rng.normal();
  return values;
}

inline MatX dense(const BlockMatrix& A) {
  MatX result = MatX::Zero(3 * A.n(), 3 * A.n());
  for (Index i = 0; i < A.n(); ++i)
    for (auto s = A.row_start()[static_cast<std::size_t>(i)];
         s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
      result.block<3, 3>(3 * i, 3 * A.columns()[static_cast<std::size_t>(s)]) =
          A.blocks()[static_cast<std::size_t>(s)];
  return result;
}

}  // namespace coxa::solve::test
