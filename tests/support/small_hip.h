#pragma once

#include <coxa/mesh/tet_mesh.h>
#include <coxa/mesh/tri_mesh.h>

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <vector>

#include "joint/layers.h"
#include "support/shapes.h"

/// A hip of spheres and cylinders, small enough that every stage of a run takes about a second.
namespace coxa::test {

// of the small hip, mm and rad; its joint centre is the origin, LPS axes, a right hip
inline constexpr double kHeadRadius = 23.0, kNeckRadius = 14.0;
inline constexpr double kSocketRadius = 26.0, kSocketAngle = radians(60.0);
inline constexpr double kNeckTilt = radians(45.0);  ///< below the horizontal, in the coronal plane

/// A head on a cylindrical neck that points to the right (of the patient) and down.
inline TriMesh small_femur(double neck_length = 45.0) {
  std::vector<Vec2> profile;
  const double neck_from = std::acos(-std::sqrt(1.0 - std::pow(kNeckRadius / kHeadRadius, 2)));
  for (double a = 0.03; a < neck_from; a += 0.06)
    profile.emplace_back(-kHeadRadius * std::cos(a), kHeadRadius * std::sin(a));
  for (double x = 18.5; x <= neck_length; x += 1.5) profile.emplace_back(x, kNeckRadius);
  TriMesh femur = revolved(profile, 60);
  // the axis of revolution to (-cos, 0, -sin): a turn about y, which keeps the orientation
  Mat3 R;
  R << -std::cos(kNeckTilt), 0, std::sin(kNeckTilt), 0, 1, 0, -std::sin(kNeckTilt), 0,
      -std::cos(kNeckTilt);
  femur.points *= R.transpose();
  return femur;
}

/// The surface of a tetrahedral mesh, its vertices numbered anew.
inline TriMesh surface_of(const TetMesh& tets) {
  std::map<Index, Index> number;
  for (Index f = 0; f < tets.facets.rows(); ++f)
    for (int c = 0; c < 3; ++c)
      number.emplace(tets.facets(f, c), static_cast<Index>(number.size()));
  TriMesh mesh;
  mesh.points.resize(static_cast<Index>(number.size()), 3);
  for (const auto& [old, now] : number) mesh.points.row(now) = tets.points.row(old);
  mesh.triangles = tets.facets.unaryExpr([&](Index v) { return number.at(v); });
  return mesh;
}

inline TetMesh small_socket_cartilage() {
  return cap_shell(kSocketRadius, kSocketRadius - 1.5, kSocketAngle, 10, 1);
}
inline TetMesh small_head_cartilage() {
  return cap_shell(kHeadRadius, kSocketRadius - 1.5, radians(75.0), 12, 1);
}
inline TriMesh small_hip_bone() {
  return surface_of(cap_shell(kSocketRadius + 8.0, kSocketRadius, kSocketAngle, 14, 1));
}

}  // namespace coxa::test
