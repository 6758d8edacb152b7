#pragma once

#include <coxa/fem/elastic_force.h>

namespace coxa::fem {

/// Stress and strain of every element, world axes.
struct ElementFields {
  std::vector<Mat3> deformation_gradient;  ///< M
  std::vector<Mat3> green_strain;          ///< M, (F^T F - I) / 2
  std::vector<Mat3> cauchy_stress;         ///< M, MPa
  Points principal_strain;                 ///< M×3, of the Green strain, descending
  Points principal_stress;                 ///< M×3, MPa, descending, tension positive
  VecX von_mises;                          ///< M, MPa
  VecX volume_ratio;                       ///< M, det F
};

/// The fields at positions x.
/// @note cost O(M); bit-identical for any number of threads
ElementFields compute_fields(const ElasticForce& force, const VecX& x);

/// Eigenvalues of a symmetric tensor, descending.
Vec3 principal_values(const Mat3& tensor);
/// sqrt(3/2) times the norm of the deviator, MPa.
double von_mises_stress(const Mat3& cauchy_stress);
/// sqrt(2/3 dev E : dev E), E Green's strain of a deformation gradient.
double effective_strain(const Mat3& F);

/// Values per element averaged to the nodes, weighted by reference volume.
/// @param values M×k   @returns N×k; NaN at nodes of no element
MatX recover_to_nodes(const TetMesh& mesh, const VecX& volumes, const MatX& values);

}  // namespace coxa::fem
