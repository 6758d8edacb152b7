#include "slide_guide.h"

#include <Eigen/Geometry>

namespace coxa::meshing {

Eigen::Matrix<double, 3, 2> tangents(const Vec3& n) {
  Eigen::Index k = 0;
  n.cwiseAbs().minCoeff(&k);
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = n.cross(Vec3::Unit(k)).normalized();
  result.col(1) = n.cross(result.col(0));
  return result;
}

}  // namespace coxa::meshing
