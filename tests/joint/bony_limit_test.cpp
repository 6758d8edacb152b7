#include <coxa/joint/simulate.h>

#include <gtest/gtest.h>

#include <cmath>

#include "joint/layers.h"
#include "joint/movements.h"
#include "support/shapes.h"

namespace coxa::joint {
namespace {

constexpr double kRim = 40.0, kRimAngle = radians(50.0), kRimRadius = 3.0, kNeckRadius = 8.0;

/// Closed cylinder about z from z = 0 down to -length.
TriMesh neck(double radius, double length, Index around = 48, Index along = 60) {
  TriMesh mesh;
  mesh.points.resize(around * (along + 1) + 2, 3);
  std::vector<Eigen::Matrix<Index, 1, 3>> triangles;
  const auto id = [&](Index ring, Index k) { return ring * around + k % around; };
  for (Index ring = 0; ring <= along; ++ring) {
    for (Index k = 0; k < around; ++k) {
      const double turn = 2.0 * kPi * k / around;
      mesh.points.row(id(ring, k)) << radius * std::cos(turn), radius * std::sin(turn),
          -length * ring / along;
    }
  }
  const Index top = around * (along + 1), bottom = top + 1;
  mesh.points.row(top) << 0, 0, 0;
  mesh.points.row(bottom) << 0, 0, -length;
  for (Index k = 0; k < around; ++k) {
    triangles.emplace_back(top, id(0, k), id(0, k + 1));
    triangles.emplace_back(bottom, id(along, k + 1), id(along, k));
    for (Index ring = 0; ring < along; ++ring) {
      triangles.emplace_back(id(ring, k), id(ring + 1, k), id(ring + 1, k + 1));
      triangles.emplace_back(id(ring, k), id(ring + 1, k + 1), id(ring, k + 1));
    }
  }
  mesh.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.row(static_cast<Index>(t)) = triangles[t];
  return mesh;
}

/// A ball in a cup with a cylindrical neck and a rim that is a torus: the neck meets it at a known
/// angle.
JointModel with_bones() {
  JointModel model = test::make_ball_in_cup({.cup_rings = 5, .head_rings = 7, .layers = 1});
  model.femur = neck(kNeckRadius, 60.0);
  model.hip_bone = test::torus(kRim * std::sin(kRimAngle), kRimRadius, 160, 40);
  model.hip_bone.points.col(2).array() -= kRim * std::cos(kRimAngle);
  return model;
}

}  // namespace

TEST(BonyLimit, IsWhereTheNeckMeetsTheRim) {
  const JointModel model = with_bones();
  const auto motion = test::movement_to({radians(48.0), 0.0, 0.0}, 9);
  const JointResult result =
      simulate(model, motion, passive_examination(model, 200.0), {.centre_shift = std::nullopt});
  // the rim's ring lies kRim sin(angle between) from the neck's axis
  const double exact = kRimAngle - std::asin((kNeckRadius + kRimRadius) / kRim);
  ASSERT_TRUE(result.bony_limit.has_value());
  EXPECT_NEAR(result.bony_limit->angles.flexion, exact, radians(0.5));
  EXPECT_EQ(result.bony_limit->frame, 6);          // 36 degrees, the first past 34
  EXPECT_NEAR(result.bony_limit->hour, 3.0, 0.1);  // flexion takes the neck forward
  EXPECT_NEAR(result.bony_limit->place.y(), -26.0, 3.0);
  for (const FrameResult& frame : result.frames) {
    EXPECT_EQ(frame.status,
              frame.frame < 6 ? FrameStatus::converged : FrameStatus::beyond_bony_limit);
    EXPECT_EQ(frame.acetabular_pressure.size() > 0, frame.frame < 6);
    EXPECT_EQ(frame.reason.empty(), frame.frame < 6);
  }
}
TEST(BonyLimit, IsNotLookedForWithoutBones) {
  const JointModel model = test::make_ball_in_cup({.cup_rings = 5, .head_rings = 7, .layers = 1});
  const JointResult result =
      simulate(model, test::movement_to({}, 1), passive_examination(model, 200.0),
               {.centre_shift = std::nullopt});
  EXPECT_FALSE(result.bony_limit.has_value());
  EXPECT_TRUE(std::isnan(result.frames[0].bone_clearance));
}
TEST(BonyLimit, DoesNotCountTheCoveredHead) {
  JointModel model = with_bones();
  // a head inside the cartilage, and a hip bone that overlaps it there
  model.femur = test::icosphere(3, 23.0);
  model.hip_bone = test::icosphere(3, 5.0, Vec3(0, 0, 24.0));
  const JointResult result =
      simulate(model, test::movement_to({}, 1), passive_examination(model, 200.0),
               {.centre_shift = std::nullopt});
  EXPECT_EQ(result.frames[0].status, FrameStatus::converged) << result.frames[0].reason;
}

}  // namespace coxa::joint
