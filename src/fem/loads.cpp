#include <coxa/fem/loads.h>

#include "element_shape.h"

namespace coxa::fem {

VecX body_load(const TetMesh& mesh, const Vec3& density) {
  check_connectivity(mesh);
  const int n = nodes_per_element(mesh);
  // the integral of a shape function over its element, per volume: ten nodes, corners -1/20,
  // middles 1/5
  const double corner = n == 4 ? 0.25 : -0.05, middle = 0.2;
  VecX load = VecX::Zero(3 * Eigen::Index{mesh.n_vertices()});
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    double volume = 0.0;
    for (const double weight : element_shape(mesh, e).weight) volume += weight;
    for (int a = 0; a < n; ++a)
      load.segment<3>(3 * element_node(mesh, e, a)) += volume * (a < 4 ? corner : middle) * density;
  }
  return load;
}

}  // namespace coxa::fem
