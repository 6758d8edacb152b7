#include <coxa/measure/hip_angles.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/shapes.h"

namespace coxa::measure {

TEST(AcetabularOrientation, OfTheAxisBuiltFromTwoAnglesIsThoseAngles) {
  const double inclination = radians(50.0), version = radians(18.0);
  for (const Side side : {Side::right, Side::left}) {
    const double outward = side == Side::right ? 1.0 : -1.0;
    const Vec3 axis(std::sin(inclination) * std::sin(version), -std::cos(inclination),
                    outward * std::sin(inclination) * std::cos(version));
    const AcetabularOrientation orientation = acetabular_orientation(3.0 * axis, side);
    EXPECT_NEAR(orientation.inclination, inclination, 1e-12);
    EXPECT_NEAR(orientation.version, version, 1e-12);
  }
}
TEST(LateralCentreEdgeAngle, IsMeasuredFromUpwardsTowardsLateral) {
  const Vec3 centre(3, 4, 80);
  const double angle = radians(32.0);
  for (const Side side : {Side::right, Side::left}) {
    const double outward = side == Side::right ? 1.0 : -1.0;
    const Vec3 edge = centre + Vec3(5.0, 20.0 * std::cos(angle), outward * 20.0 * std::sin(angle));
    EXPECT_NEAR(lateral_centre_edge_angle(centre, edge, side), angle, 1e-12);
  }
}
TEST(FindLateralEdge, IsTheMostLateralVertexNearTheCoronalPlane) {
  // the upper half of a sphere cut at 30 degrees lateral of upwards
  TriMesh socket = test::icosphere(4, 20.0);
  std::vector<Index> kept;
  for (Index v = 0; v < socket.n_vertices(); ++v) {
    const Vec3 p = socket.points.row(v);
    if (std::atan2(p.z(), p.y()) < radians(30.0)) kept.push_back(v);
  }
  socket.points = Points(socket.points(kept, Eigen::all));
  const Vec3 edge = find_lateral_edge(socket, Vec3::Zero(), Side::right);
  EXPECT_NEAR(lateral_centre_edge_angle(Vec3::Zero(), edge, Side::right), radians(30.0),
              radians(3.0));
  EXPECT_THROW(find_lateral_edge(socket, Vec3(0, 40, 0), Side::right), Error);
  EXPECT_THROW(find_lateral_edge(socket, Vec3::Zero(), Side::right, 0.0), Error);
}
TEST(NeckShaftAngle, IsTheAngleBetweenNeckAndShaftWhateverTheirPlace) {
  const RigidTransform X = test::some_pose();
  const double angle = radians(127.0);
  const Vec3 neck_centre = Vec3::Zero(), shaft(0, -80, 0);
  const Vec3 head = 30.0 * Vec3(std::sin(angle), -std::cos(angle), 0);
  EXPECT_NEAR(neck_shaft_angle(X * head, X * neck_centre, X.R * shaft), angle, 1e-12);
}

/// Sphere about the origin with a neck along +z: whatever of a cone of half-angle `cone` stands out
/// of it.
TriMesh head_and_neck(double radius, double cone) {
  TriMesh femur = test::icosphere(5, radius);
  for (Index v = 0; v < femur.n_vertices(); ++v) {
    const Vec3 p = femur.points.row(v);
    if (std::acos(p.z() / radius) < cone) femur.points.row(v) *= 2.0;
  }
  return femur;
}
TEST(AlphaAngle, OfASphereWithANeckIsTheNecksHalfAngle) {
  const TriMesh femur = head_and_neck(24.0, radians(48.0));
  const Sphere head{.centre = Vec3::Zero(), .radius = 24.0};
  const double edge = radians(2.5);  // of the mesh, seen from the centre
  for (const Vec3& towards : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 0.3)}) {
    EXPECT_NEAR(alpha_angle(femur, head, Vec3(0, 0, 5), towards), radians(48.0), edge);
  }
}
TEST(AlphaAngle, ToleranceStepAndLargestMatter) {
  const TriMesh femur = head_and_neck(24.0, radians(48.0));
  const Sphere head{.centre = Vec3::Zero(), .radius = 24.0};
  const auto alpha = [&](const AlphaAngleOptions& options) {
    return alpha_angle(femur, head, Vec3::UnitZ(), Vec3::UnitX(), options);
  };
  EXPECT_TRUE(std::isnan(alpha({.tolerance = 30.0})));
  EXPECT_LT(alpha({.tolerance = 20.0}), alpha({.tolerance = 1.0}));
  EXPECT_NEAR(alpha({.largest = radians(30.0)}), radians(30.0), 1e-12);
  EXPECT_NEAR(alpha({.step = radians(40.0)}), radians(40.0), 1e-9);  // 120, 80, 40
  EXPECT_THROW(alpha({.tolerance = 0.0}), Error);
  EXPECT_THROW(alpha({.step = 0.0}), Error);
  EXPECT_THROW(alpha({.largest = 4.0}), Error);
  EXPECT_THROW(alpha_angle(femur, head, Vec3::UnitZ(), Vec3::UnitZ()), Error);
}

}  // namespace coxa::measure
