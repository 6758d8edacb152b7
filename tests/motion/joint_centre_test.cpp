#include <coxa/motion/joint_centre.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <coxa/motion/bone_frames.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace coxa::motion {
namespace {

// a head of radius 24 about the origin on a neck that widens to a trochanter, along +x
TriMesh head_on_neck() {
  std::vector<Vec2> profile;
  for (double a = 0.02; a < 2.4; a += 0.04)
    profile.emplace_back(-24 * std::cos(a), 24 * std::sin(a));
  for (double x = 20; x < 60; x += 1.5) profile.emplace_back(x, 15.0 + 0.012 * (x - 20) * (x - 20));
  return test::revolved(profile, 90);
}

// a socket: part of a sphere shell from radius 25 to 27 about c, opening along +x
TriMesh socket_shell(const Vec3& c) {
  std::vector<Vec2> profile;
  for (double a = 0.05; a < 1.35; a += 0.04)
    profile.emplace_back(-27 * std::cos(a), 27 * std::sin(a));
  for (double a = 1.33; a > 0.03; a -= 0.04)
    profile.emplace_back(-25 * std::cos(a), 25 * std::sin(a));
  TriMesh mesh = test::revolved(profile, 90);
  mesh.points.rowwise() += c.transpose();
  return mesh;
}

// the same without the triangles that close it at its last vertex
TriMesh open_at_the_end(TriMesh mesh) {
  const Index last = mesh.n_vertices() - 1;
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    if ((mesh.triangles.row(t).array() != last).all()) kept.push_back(t);
  }
  mesh.triangles = Triangles(mesh.triangles(kept, Eigen::all));
  return mesh;
}

TriMesh noisy(TriMesh mesh, double sd, std::uint64_t seed) {
  Rng rng(seed);
  for (Index v = 0; v < mesh.n_vertices(); ++v) mesh.points.row(v) += sd * rng.normal3();
  return mesh;
}

}  // namespace

TEST(JointCentre, FindsTheHeadOfAFemurWithoutAHint) {
  SurfaceSet surfaces;
  surfaces["femur"].mesh = head_on_neck();
  const auto result = find_joint_centre(surfaces);
  EXPECT_LE(result.chosen.centre.norm(), 0.05);
  EXPECT_NEAR(result.chosen.radius, 24.0, 0.05);
  EXPECT_EQ(result.chosen.definition, "femoral_head");
  EXPECT_GT(result.chosen.covered_share, 0.4);
  EXPECT_LT(result.chosen.interval, 0.2);
}
TEST(JointCentre, HoldsUnderHalfAMillimetreOfNoise) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SurfaceSet surfaces;
    surfaces["femur"].mesh = noisy(head_on_neck(), 0.5, seed);
    EXPECT_LE(find_joint_centre(surfaces).chosen.centre.norm(), 0.3);
  }
}
TEST(JointCentre, MovesWithTheSurfaces) {
  const RigidTransform X{rotation_from_vector(Vec3(0.5, -0.8, 1.1)), Vec3(90, -40, -700)};
  SurfaceSet surfaces;
  surfaces["femur"].mesh = head_on_neck();
  surfaces["femur"].mesh.points = transformed(surfaces["femur"].mesh.points, X);
  EXPECT_LE(
      (find_joint_centre(surfaces, {.start = X.p + Vec3(4, -3, 2)}).chosen.centre - X.p).norm(),
      0.05);
}
TEST(JointCentre, ReportsEveryDefinitionSideBySide) {
  SurfaceSet surfaces;
  surfaces["femur"].mesh = head_on_neck();
  surfaces["acetabular_cartilage"].mesh = socket_shell(Vec3(1, 0, 0));
  const auto result = find_joint_centre(surfaces);
  ASSERT_EQ(result.all.size(), 4u);
  EXPECT_EQ(result.all[1].definition, "acetabular_cartilage");
  EXPECT_NEAR(result.all[1].radius, 25.0, 0.1);
  EXPECT_LE((result.all[1].centre - Vec3(1, 0, 0)).norm(), 0.1);
  EXPECT_EQ(result.all[2].definition, "acetabulum");
  EXPECT_NEAR(result.all[2].radius, 27.0, 0.1);
  EXPECT_EQ(result.all[3].definition, "congruency");
  EXPECT_NEAR(result.largest_spread, 1.0, 0.3);
}
TEST(JointCentre, ByCongruencyIsTheCentreOfARoundHead) {
  std::vector<Vec2> profile;
  for (double a = 0.02; a < kPi - 0.01; a += 0.05)
    profile.emplace_back(-24 * std::cos(a), 24 * std::sin(a));
  const TriMesh head = test::revolved(profile, 90);
  std::vector<Vec2> cup;
  for (double a = 0.05; a < 1.4; a += 0.05) cup.emplace_back(-25 * std::cos(a), 25 * std::sin(a));
  const auto centre =
      congruency_centre(head, open_at_the_end(test::revolved(cup, 60)), Vec3(0.6, -0.5, 0.4), 150);
  EXPECT_LE(centre.centre.norm(), 0.05);
  EXPECT_LE(centre.rms, 0.05);
}
TEST(JointCentre, NeedsASurface) {
  EXPECT_THROW(find_joint_centre({}), Error);
  SurfaceSet surfaces;
  surfaces["femur"].mesh = head_on_neck();
  EXPECT_THROW(find_joint_centre(surfaces, {.smallest_radius = 30.0, .largest_radius = 20.0}),
               Error);
}
TEST(JointCentre, IsBitIdenticalForOneAndEightThreads) {
  SurfaceSet surfaces;
  surfaces["femur"].mesh = head_on_neck();
  surfaces["acetabular_cartilage"].mesh = socket_shell(Vec3(0.5, 0, 0));
  const auto run = [&] {
    std::vector<double> numbers;
    for (const auto& c : find_joint_centre(surfaces, {.congruency_samples = 60}).all) {
      numbers.insert(numbers.end(), {c.centre.x(), c.centre.y(), c.centre.z(), c.interval});
    }
    return numbers;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

TEST(BoneFrames, FollowIsbFromLandmarks) {
  const Mat3 P = pelvis_axes(Vec3(-120, -50, 0), Vec3(120, -50, 0), Vec3(0, 100, 0));  // LPS
  EXPECT_LE((P - supine_axes()).norm(), 1e-12);
  for (const Side side : {Side::left, Side::right}) {
    const double s = side == Side::right ? -1.0 : 1.0;  // LPS x is left
    const Mat3 F =
        femur_axes(Vec3(s * 90, 0, 0), Vec3(s * 50, 0, -400), Vec3(s * 130, 0, -400), side);
    EXPECT_LE((F - supine_axes()).norm(), 1e-12);
  }
}
TEST(BoneFrames, SayWhereTheyComeFrom) {
  FrameLandmarks landmarks{.points = {{"asis_right", Vec3(-120, -50, 0)},
                                      {"asis_left", Vec3(120, -50, 0)},
                                      {"psis_right", Vec3(-45, 100, 0)},
                                      {"medial_epicondyle", Vec3(-50, 0, -480)},
                                      {"lateral_epicondyle", Vec3(-130, 0, -480)}},
                           .source = "landmarks"};
  const Vec3 centre(-90, 0, -80);
  const auto whole = make_bone_frames({}, landmarks, centre, Side::right);
  EXPECT_EQ(whole.pelvis.source, "landmarks");
  EXPECT_EQ(whole.femur.source, "landmarks");
  EXPECT_EQ(whole.pelvis.X_IB.p, centre);
  EXPECT_LE((whole.pelvis.X_IB.R - supine_axes()).norm(), 1e-12);
  landmarks.points.erase("asis_left");
  const auto half = make_bone_frames({}, landmarks, centre, Side::right);
  EXPECT_EQ(half.pelvis.source, "landmarks (one side) and image axes");
  EXPECT_GT(half.pelvis.interval, whole.pelvis.interval);
  const auto none = make_bone_frames({}, {}, centre, Side::right);
  EXPECT_EQ(none.pelvis.source, "image axes");
  EXPECT_EQ(none.femur.source, "image axes");
}
// a head at the origin, a shaft, and a knee of two balls whose common axis is turned about the
// shaft; vertices only, which is all the rule looks at
TriMesh femur_with_knee(double turn, Side side) {
  const double s = side == Side::right ? -1.0 : 1.0;
  std::vector<Vec3> points;
  for (double z = 0; z > -380; z -= 4) points.push_back({s * 20, 0, z});
  const Vec3 lateral(s * std::cos(turn), std::sin(turn), 0);
  for (const double end : {-1.0, 1.0}) {
    for (int i = 0; i < 60; ++i) {
      for (int j = 0; j <= 30; ++j) {
        const double a = 2 * kPi * i / 60, b = kPi * j / 30;
        points.push_back(
            Vec3(s * 20, 0, -390) + end * 22 * lateral +
            22 * Vec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)));
      }
    }
  }
  TriMesh femur;
  femur.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k)
    femur.points.row(static_cast<Eigen::Index>(k)) = points[k];
  femur.triangles.resize(1, 3);
  femur.triangles << 0, 1, 2;
  return femur;
}
TEST(BoneFrames, FindTheEpicondylesOfAWholeFemur) {
  for (const Side side : {Side::left, Side::right}) {
    const double turn = radians(12.0);
    SurfaceSet surfaces;
    surfaces["femur"].mesh = femur_with_knee(turn, side);
    const auto found = find_epicondyles(surfaces["femur"].mesh, Vec3::Zero(), side);
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->lateral - found->medial).norm(), 88.0, 4.0);
    const auto frames = make_bone_frames(surfaces, {}, Vec3::Zero(), side);
    EXPECT_EQ(frames.femur.source, "epicondyles found on the surface");
    EXPECT_EQ(frames.landmarks.count(side == Side::right ? "lateral_epicondyle_right"
                                                         : "lateral_epicondyle_left"),
              1U);
    const Vec3 right =
        side == Side::right ? found->lateral - found->medial : Vec3(found->medial - found->lateral);
    EXPECT_GT(frames.femur.X_IB.R.col(2).dot(right.normalized()), 0.995);
    EXPECT_NEAR(std::abs(frames.femur.X_IB.R(1, 2)), std::sin(turn), 0.02);
  }
  TriMesh cut = femur_with_knee(0.0, Side::right);
  cut.points.col(2) = cut.points.col(2).cwiseMax(-250.0);
  EXPECT_FALSE(find_epicondyles(cut, Vec3::Zero(), Side::right));
}
TEST(BoneFrames, RefuseLandmarksThatSpanNothing) {
  EXPECT_THROW(pelvis_axes(Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(0, 100, 0)), Error);
  EXPECT_THROW(pelvis_axes(Vec3(-120, 0, 0), Vec3(120, 0, 0), Vec3(0, 1, 0)), Error);
}

}  // namespace coxa::motion
