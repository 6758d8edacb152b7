#include <coxa/fem/results.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "element_shape.h"

namespace coxa::fem {

Vec3 principal_values(const Mat3& tensor) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(tensor, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().reverse();
}

double von_mises_stress(const Mat3& cauchy_stress) {
  const Mat3 deviator = cauchy_stress - cauchy_stress.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

double effective_strain(const Mat3& F) {
  const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
  return std::sqrt(2.0 / 3.0) * (E - E.trace() / 3.0 * Mat3::Identity()).norm();
}

ElementFields compute_fields(const ElasticForce& force, const VecX& x) {
  const Index n = force.n_elements();
  const auto size = static_cast<std::size_t>(n);
  ElementFields fields{std::vector<Mat3>(size),
                       std::vector<Mat3>(size),
                       std::vector<Mat3>(size),
                       Points(n, 3),
                       Points(n, 3),
                       VecX(n),
                       VecX(n)};
  parallel_for(n, [&](Index e) {
    const auto at = static_cast<std::size_t>(e);
    const Mat3 F = force.deformation_gradient(x, e);
    const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
    const Mat3 stress = force.cauchy_stress(x, e);
    fields.deformation_gradient[at] = F;
    fields.green_strain[at] = E;
    fields.cauchy_stress[at] = stress;
    fields.principal_strain.row(e) = principal_values(E).transpose();
    fields.principal_stress.row(e) = principal_values(stress).transpose();
    fields.von_mises[e] = von_mises_stress(stress);
    fields.volume_ratio[e] = F.determinant();
  });
  return fields;
}

MatX recover_to_nodes(const TetMesh& mesh, const VecX& volumes, const MatX& values) {
  require(volumes.size() == mesh.n_tets() && values.rows() == mesh.n_tets(), "the mesh has ",
          mesh.n_tets(), " elements, got ", volumes.size(), " volumes and ", values.rows(),
          " values");
  MatX sum = MatX::Zero(mesh.n_vertices(), values.cols());
  VecX weight = VecX::Zero(mesh.n_vertices());
  for (Index e = 0; e < mesh.n_tets(); ++e)
    for (int a = 0; a < nodes_per_element(mesh); ++a) {
      const Index node = element_node(mesh, e, a);
      sum.row(node) += volumes[e] * values.row(e);
      weight[node] += volumes[e];
    }
  for (Index i = 0; i < mesh.n_vertices(); ++i) sum.row(i) /= weight[i] > 0.0 ? weight[i] : kNaN;
  return sum;
}

}  // namespace coxa::fem
