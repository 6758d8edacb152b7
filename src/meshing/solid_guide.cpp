#include "solid_guide.h"

#include <Eigen/Geometry>

namespace coxa::meshing {

Vec3 SolidGuide::place(NodeKind kind, const Vec3& p) const {
  if (kind == NodeKind::first_crease) return features_.nearest(p).point;
  return is_fixed(kind) || kind == NodeKind::inside ? p : surface_.nearest(p).point;
}

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> SolidGuide::directions(NodeKind kind,
                                                                         const Vec3& p) const {
  if (kind == NodeKind::inside) return Mat3::Identity();
  if (kind == NodeKind::first_crease) return features_.nearest(p).direction;
  if (kind != NodeKind::first_face) return Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>(3, 0);
  const auto corner = [&, t = surface_.nearest(p).triangle](int k) {
    return Vec3(surface_.points().row(surface_.triangles()(t, k)));
  };
  return tangents((corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized());
}

}  // namespace coxa::meshing
