#pragma once

#include <coxa/fem/material.h>

namespace coxa::fem {

/// Elements worked on at once, one a lane.
inline constexpr int kLanes = 4;
using Lanes __attribute__((vector_size(8 * kLanes))) = double;

/// A matrix per lane.
struct LaneMat3 {
  Lanes at[3][3];  ///< row, column
};

inline Mat3 matrix_of(const LaneMat3& matrices, int lane) {
  Mat3 matrix;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix(i, j) = matrices.at[i][j][lane];
  return matrix;
}
inline void set_matrix(LaneMat3& matrices, int lane, const Mat3& matrix) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrices.at[i][j][lane] = matrix(i, j);
}

/// Where four four-node elements have what their force needs.
struct LaneElements {
  const double* position[kLanes][4];  ///< of each node, mm
  const double* gradient[kLanes];     ///< 12 values: dN_a/dX, node by node, 1/mm
  double weight[kLanes];              ///< mm³
  double* force[kLanes];              ///< 12 values, node by node, N
};

// each is made for processors with wide registers and for those without, with the same rounding

/// F of every element.
void deformation_gradients(const LaneElements& elements, LaneMat3& F);
/// Sets the nodes' forces, -weight P r.
void set_node_forces(const LaneElements& elements, const LaneMat3& P);
/// The rotation in F = R S; bit k of what is returned is set where lane k is too flat for it and
/// left to the singular values, as by `polar_rotation`.
unsigned polar_rotations(const LaneMat3& F, LaneMat3& R);
/// The corotational law's stress and energy density for F = R S.
void corotational_response(const Lame& lame, const LaneMat3& F, const LaneMat3& R, LaneMat3& P,
                           double* energy);
/// A : B of every lane.
void inner_products(const LaneMat3& A, const LaneMat3& B, double* products);
/// Least det F of the lanes.
double least_determinant(const LaneMat3& F);

}  // namespace coxa::fem
