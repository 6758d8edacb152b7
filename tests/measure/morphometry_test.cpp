#include <coxa/measure/morphometry.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "support/shapes.h"
#include "support/small_hip.h"

namespace coxa::measure {
namespace {

/// The small femur with a shaft below the end of its neck, its neck turned back by `version`.
TriMesh femur_with_shaft(double version, Side side = Side::right) {
  TriMesh femur = test::small_femur();
  std::vector<Vec2> profile;
  for (double x = 0.0; x <= 130.0; x += 2.0) profile.emplace_back(x, 12.0);
  TriMesh shaft = test::revolved(profile, 48);
  // +x to -z, then below the end of the neck
  shaft.points = transformed(
      shaft.points, {Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitY()).matrix(), Vec3(-42, 0, -42)});
  const Index n = femur.n_vertices(), t = femur.n_triangles();
  femur.points.conservativeResize(n + shaft.n_vertices(), 3);
  femur.points.bottomRows(shaft.n_vertices()) = shaft.points;
  femur.triangles.conservativeResize(t + shaft.n_triangles(), 3);
  femur.triangles.bottomRows(shaft.n_triangles()) = shaft.triangles.array() + n;
  // seen from above, a right femur turns clockwise: its neck goes to the right and back (LPS +y)
  femur.points *= Eigen::AngleAxisd(-version, Vec3::UnitZ()).matrix().transpose();
  if (side == Side::left) {
    femur.points.col(0) *= -1.0;
    femur.triangles.col(1).swap(femur.triangles.col(2));
  }
  return femur;
}

motion::BoneFrames supine_frames(const std::string& source = "landmarks") {
  motion::BoneFrames frames;
  frames.pelvis.X_IB.R = frames.femur.X_IB.R = motion::supine_axes();
  frames.pelvis.source = frames.femur.source = source;
  return frames;
}
motion::JointCentre head() {
  motion::JointCentre centre;
  centre.radius = test::kHeadRadius;
  centre.rms = 0.01;
  return centre;
}

/// A cap of 60 degrees whose opening has these angles in the supine pelvis frame.
TriMesh socket_with(double inclination, double version, Side side) {
  const double lateral = side == Side::right ? -1.0 : 1.0;  // LPS x is left
  const Vec3 axis(lateral * std::sin(inclination) * std::cos(version),
                  -std::sin(inclination) * std::sin(version), -std::cos(inclination));
  TriMesh socket = test::surface_of(test::cap_shell(26.0, 24.5, radians(60.0), 24, 1));
  const Mat3 R = Eigen::Quaterniond::FromTwoVectors(-Vec3::UnitZ(), axis).toRotationMatrix();
  socket.points *= R.transpose();
  return socket;
}

Morphometry of_femur(const TriMesh& femur, Side side = Side::right,
                     const motion::BoneFrames& frames = supine_frames()) {
  SurfaceSet surfaces;
  surfaces["femur"].mesh = femur;
  return hip_morphometry(surfaces, frames, head(), side);
}

}  // namespace

TEST(Morphometry, NeckShaftAngleIsTheOneBuilt) {
  EXPECT_NEAR(degrees(of_femur(femur_with_shaft(0.0)).neck_shaft_angle), 135.0, 0.5);
}
TEST(Morphometry, FemoralVersionIsTheTurnOfTheNeckOnBothSides) {
  for (const Side side : {Side::right, Side::left}) {
    for (const double version : {radians(-10.0), radians(15.0)}) {
      const Morphometry result = of_femur(femur_with_shaft(version, side), side);
      EXPECT_NEAR(degrees(result.femoral_version), degrees(version), 0.5);
      EXPECT_NEAR(degrees(result.neck_shaft_angle), 135.0, 0.5);
    }
  }
}
TEST(Morphometry, FemoralVersionNeedsTheEpicondyles) {
  const Morphometry result =
      of_femur(femur_with_shaft(0.2), Side::right, supine_frames("shaft and neck"));
  EXPECT_TRUE(std::isnan(result.femoral_version));
  ASSERT_EQ(result.notes.size(), 2u);
  EXPECT_NE(result.notes[0].find("comes from shaft and neck"), std::string::npos);
}
TEST(Morphometry, AlphaAngleOfARoundNeckIsTheSameAllAround) {
  // the neck leaves the head where it is farther from the centre than the sphere and 0.75 mm
  const double alpha = std::asin(test::kNeckRadius / (test::kHeadRadius + 0.75));
  const Morphometry result = of_femur(femur_with_shaft(0.0));
  for (const double measured : result.alpha_angle)
    EXPECT_NEAR(degrees(measured), degrees(alpha), 1.0);
}
TEST(Morphometry, AlphaAngleFindsABumpAndItsHour) {
  for (const Side side : {Side::right, Side::left}) {
    TriMesh femur = femur_with_shaft(0.0, side);
    // a cam: anterior (LPS -y) on the head, 60 degrees from the neck
    const double lateral = side == Side::right ? -1.0 : 1.0;
    const Vec3 neck(lateral * std::sqrt(0.5), 0.0, -std::sqrt(0.5));
    const Vec3 bump = test::kHeadRadius *
                      (std::cos(radians(60.0)) * neck - std::sin(radians(60.0)) * Vec3::UnitY());
    for (Index v = 0; v < femur.n_vertices(); ++v) {
      const Vec3 p = femur.points.row(v);
      if ((p - bump).norm() < 4.0) femur.points.row(v) *= 1.15;
    }
    const Morphometry result = of_femur(femur, side);
    EXPECT_EQ(result.largest_alpha_hour, 3);
    EXPECT_GT(degrees(result.largest_alpha_angle), 58.0);
    EXPECT_LT(degrees(result.alpha_angle[9]), 40.0);
  }
}
TEST(Morphometry, AFemurWithoutShaftLeavesItsAnglesOut) {
  const Morphometry result = of_femur(test::small_femur());
  EXPECT_TRUE(std::isnan(result.neck_shaft_angle));
  EXPECT_NE(result.notes.at(0).find("shaft"), std::string::npos);
  EXPECT_EQ(result.head_radius, test::kHeadRadius);
}
TEST(Morphometry, SocketAnglesAreTheOnesBuiltOnBothSides) {
  const double inclination = radians(40.0), version = radians(18.0);
  for (const Side side : {Side::right, Side::left}) {
    SurfaceSet surfaces;
    surfaces["acetabular_cartilage"].mesh = socket_with(inclination, version, side);
    const Morphometry result = hip_morphometry(surfaces, supine_frames(), head(), side);
    EXPECT_NEAR(degrees(result.acetabular_inclination), 40.0, 0.3);
    EXPECT_NEAR(degrees(result.acetabular_version), 18.0, 0.3);
  }
}
TEST(Morphometry, LateralEdgeLiesWhereTheCapEnds) {
  // in the coronal plane the cap of 60 degrees, tipped by 35, ends 25 degrees lateral of upwards
  for (const Side side : {Side::right, Side::left}) {
    SurfaceSet surfaces;
    surfaces["acetabular_cartilage"].mesh = socket_with(radians(35.0), 0.0, side);
    EXPECT_NEAR(
        degrees(hip_morphometry(surfaces, supine_frames(), head(), side).lateral_centre_edge_angle),
        25.0, 1.0);
  }
}
TEST(SocketAxis, IsUnchangedByTheNotchOfAHorseshoe) {
  TriMesh socket = socket_with(radians(40.0), 0.3, Side::right);
  const Vec3 whole = socket_axis(socket, Vec3::Zero());
  // cut a wedge out of the lower side
  std::vector<Index> kept;
  for (Index t = 0; t < socket.n_triangles(); ++t) {
    const Vec3 p = socket.points.row(socket.triangles(t, 0));
    if (!(p.z() < 8.0 && std::abs(p.y()) < 8.0)) kept.push_back(t);
  }
  TriMesh horseshoe = socket;
  horseshoe.triangles = Triangles(socket.triangles(kept, Eigen::all));
  EXPECT_LE(std::acos(socket_axis(horseshoe, Vec3::Zero()).dot(whole)), radians(0.5));
}
TEST(SocketAxis, RefusesASphere) {
  EXPECT_THROW(socket_axis(test::icosphere(3, 25.0), Vec3::Zero()), Error);
}

}  // namespace coxa::measure
