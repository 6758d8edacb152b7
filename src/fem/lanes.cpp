#include "lanes.h"

#include <algorithm>
#include <cmath>

#include "polar_rotation.h"

// Made twice, chosen at start by what the processor has. Neither contracts products and sums, so
// both round alike.
#define COXA_IN_LANES __attribute__((target_clones("avx2", "default")))
// Part of such a function: made with it.
#define COXA_LANE_PART inline __attribute__((always_inline))

// g++ 12 takes lanes that are filled one after the other for read before they are set
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

namespace coxa::fem {
namespace {

COXA_LANE_PART void set_rank_three(const Lanes (&A)[3][3], const Lanes (&B)[3][3],
                                   Lanes (&C)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j];
}

/// C_ij = det(F) times the inverse transposed.
COXA_LANE_PART void set_cofactors(const Lanes (&F)[3][3], Lanes (&C)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      C[i][j] = F[k][m] * F[l][n] - F[k][n] * F[l][m];
    }
  }
}

struct LaneVec3 {
  Lanes at[3];
};

/// Three values of each of four places side by side.
COXA_LANE_PART void gather(const double* a, const double* b, const double* c, const double* d,
                           LaneVec3& v) {
  v = LaneVec3{{Lanes{a[0], b[0], c[0], d[0]}, Lanes{a[1], b[1], c[1], d[1]},
                Lanes{a[2], b[2], c[2], d[2]}}};
}

COXA_LANE_PART void set_roots(Lanes& values) {
  for (int lane = 0; lane < kLanes; ++lane) values[lane] = std::sqrt(values[lane]);
}

/// As in polar_rotation.cpp.
COXA_LANE_PART void set_sum_of_stretches(const Lanes& a, const Lanes& b, const Lanes& J, Lanes& t) {
  t = 3.0 * a;
  set_roots(t);
  auto going = t == t;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Lanes second = 0.5 * (t * t - a), slope = 2.0 * (second * t - J);
    going &= slope > 0.0;
    const Lanes fall = (second * second - 2.0 * J * t - b) / slope;
    t = going ? t - fall : t;
    going &= fall > kLastStep * t;
    if ((going[0] | going[1] | going[2] | going[3]) == 0) break;
  }
}

}  // namespace

COXA_IN_LANES void deformation_gradients(const LaneElements& elements, LaneMat3& F) {
  F = LaneMat3{};
  for (int a = 0; a < 4; ++a) {
    LaneVec3 x, r;
    gather(elements.position[0][a], elements.position[1][a], elements.position[2][a],
           elements.position[3][a], x);
    gather(elements.gradient[0] + 3 * a, elements.gradient[1] + 3 * a, elements.gradient[2] + 3 * a,
           elements.gradient[3] + 3 * a, r);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) F.at[i][j] += x.at[i] * r.at[j];
  }
}

COXA_IN_LANES void set_node_forces(const LaneElements& elements, const LaneMat3& P) {
  const double* weight = elements.weight;
  const Lanes share = {-weight[0], -weight[1], -weight[2], -weight[3]};
  for (int a = 0; a < 4; ++a) {
    LaneVec3 r;
    gather(elements.gradient[0] + 3 * a, elements.gradient[1] + 3 * a, elements.gradient[2] + 3 * a,
           elements.gradient[3] + 3 * a, r);
    for (int i = 0; i < 3; ++i) {
      const Lanes f = share * (P.at[i][0] * r.at[0] + P.at[i][1] * r.at[1] + P.at[i][2] * r.at[2]);
      for (int lane = 0; lane < kLanes; ++lane) elements.force[lane][3 * a + i] = f[lane];
    }
  }
}

COXA_IN_LANES unsigned polar_rotations(const LaneMat3& F, LaneMat3& R) {
  Lanes transposed[3][3], C[3][3], cofactor[3][3], FC[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) transposed[i][j] = F.at[j][i];
  set_rank_three(transposed, F.at, C);
  set_rank_three(F.at, C, FC);
  set_cofactors(F.at, cofactor);
  const Lanes a = C[0][0] + C[1][1] + C[2][2];
  Lanes b = {};
  for (const auto& row : cofactor)
    for (const Lanes& entry : row) b += entry * entry;
  const Lanes J =
      F.at[0][0] * cofactor[0][0] + F.at[1][0] * cofactor[1][0] + F.at[2][0] * cofactor[2][0];
  Lanes first;
  set_sum_of_stretches(a, b, J, first);
  const Lanes second = 0.5 * (first * first - a), product = first * second - J;
  const Lanes squared_size = a / 3.0;
  Lanes size = squared_size;
  set_roots(size);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      R.at[i][j] = ((second + a) * F.at[i][j] + first * cofactor[i][j] - FC[i][j]) / product;
  const auto fits = product > kFlattest * 8.0 * squared_size * size;
  unsigned flat = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    if (fits[lane] == 0) flat |= 1U << lane;
  return flat;
}

COXA_IN_LANES void corotational_response(const Lame& lame, const LaneMat3& F, const LaneMat3& R,
                                         LaneMat3& P, double* energy) {
  Lanes sum = {}, squared = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Lanes change = F.at[i][j] - R.at[i][j];
      P.at[i][j] = 2.0 * lame.mu * change;
      sum += R.at[i][j] * change;
      squared += change * change;
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P.at[i][j] += lame.lambda * sum * R.at[i][j];
  const Lanes density = lame.mu * squared + 0.5 * lame.lambda * sum * sum;
  for (int lane = 0; lane < kLanes; ++lane) energy[lane] = density[lane];
}

COXA_IN_LANES void inner_products(const LaneMat3& A, const LaneMat3& B, double* products) {
  Lanes sum = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += A.at[i][j] * B.at[i][j];
  for (int lane = 0; lane < kLanes; ++lane) products[lane] = sum[lane];
}

COXA_IN_LANES double least_determinant(const LaneMat3& F) {
  Lanes cofactor[3][3];
  set_cofactors(F.at, cofactor);
  const Lanes J =
      F.at[0][0] * cofactor[0][0] + F.at[1][0] * cofactor[1][0] + F.at[2][0] * cofactor[2][0];
  return std::min({J[0], J[1], J[2], J[3]});
}

void Material::energies_with_piolas(const LaneMat3& F, LaneMat3& P, double* energy) const {
  for (int lane = 0; lane < kLanes; ++lane) {
    Mat3 stress;
    energy[lane] = energy_with_piola(matrix_of(F, lane), stress);
    set_matrix(P, lane, stress);
  }
}

void Material::energies_with_known_rotations(const LaneMat3& F, const LaneMat3&, LaneMat3& P,
                                             double* energy) const {
  energies_with_piolas(F, P, energy);
}

}  // namespace coxa::fem
