#include "element_shape.h"

#include <coxa/core/error.h>

#include <Eigen/LU>

#include <cmath>

namespace coxa::fem {
namespace {

using LocalGradient = Eigen::Matrix<double, Eigen::Dynamic, 4>;  // dN/dL, L barycentric

/// dN/dL at barycentric coordinates L: L_i for four nodes; L_i (2 L_i - 1) and 4 L_i L_j for ten.
LocalGradient local_gradient(int n_nodes, const Eigen::Vector4d& L) {
  LocalGradient dN = LocalGradient::Zero(n_nodes, 4);
  if (n_nodes == 4) {
    dN.setIdentity();
    return dN;
  }
  for (int i = 0; i < 4; ++i) dN(i, i) = 4.0 * L[i] - 1.0;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kEdgeCorners[static_cast<std::size_t>(k)];
    dN(4 + k, i) = 4.0 * L[j];
    dN(4 + k, j) = 4.0 * L[i];
  }
  return dN;
}

/// Barycentric coordinates of the integration points; their weights are equal.
std::vector<Eigen::Vector4d> integration_points(int n_nodes) {
  if (n_nodes == 4) return {Eigen::Vector4d::Constant(0.25)};
  const double near = (5.0 + 3.0 * std::sqrt(5.0)) / 20.0, far = (5.0 - std::sqrt(5.0)) / 20.0;
  std::vector<Eigen::Vector4d> points(4, Eigen::Vector4d::Constant(far));
  for (int i = 0; i < 4; ++i) points[static_cast<std::size_t>(i)][i] = near;
  return points;
}

}  // namespace

ElementShape element_shape(const TetMesh& mesh, Index e) {
  const int n = nodes_per_element(mesh);
  Eigen::Matrix<double, 3, Eigen::Dynamic> X(3, n);
  for (int a = 0; a < n; ++a) X.col(a) = mesh.points.row(element_node(mesh, e, a)).transpose();

  ElementShape shape;
  const auto points = integration_points(n);
  for (const Eigen::Vector4d& L : points) {
    // along coordinates 1 to 3, with coordinate 0 making up the sum of one
    const LocalGradient dN = local_gradient(n, L);
    const Eigen::Matrix<double, Eigen::Dynamic, 3> along = dN.rightCols<3>().colwise() - dN.col(0);
    const Mat3 dX = X * along, inverse = dX.inverse();
    const double weight = dX.determinant() / 6.0 / static_cast<double>(points.size());
    if (!(weight > 0.0))
      fail(ErrorCode::bad_mesh, "element ", e, " has volume ",
           weight * static_cast<double>(points.size()), " mm3; it must be positive");
    shape.weight.push_back(weight);
    const Eigen::Matrix<double, Eigen::Dynamic, 3> gradient = along * inverse;
    for (int a = 0; a < n; ++a) shape.gradient.push_back(gradient.row(a).transpose());
    shape.barycentric.push_back(L);
    shape.corner_gradient.push_back(-inverse.colwise().sum().transpose());
    for (int a = 0; a < 3; ++a) shape.corner_gradient.push_back(inverse.row(a).transpose());
  }
  return shape;
}

void check_connectivity(const TetMesh& mesh) {
  if (mesh.mid_nodes.rows() > 0 && mesh.mid_nodes.rows() != mesh.tets.rows())
    fail(ErrorCode::bad_mesh, "the mesh has mid nodes for ", mesh.mid_nodes.rows(), " of ",
         mesh.tets.rows(), " elements");
  for (Index e = 0; e < mesh.n_tets(); ++e)
    for (int a = 0; a < nodes_per_element(mesh); ++a) {
      const Index node = element_node(mesh, e, a);
      if (node < 0 || node >= mesh.n_vertices())
        fail(ErrorCode::bad_mesh, "element ", e, " names node ", node, " of ", mesh.n_vertices());
    }
}

}  // namespace coxa::fem
