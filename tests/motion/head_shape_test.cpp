#include <coxa/motion/head_shape.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/mesh/topology.h>
#include <coxa/motion/joint_centre.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace coxa::motion {
namespace {

const Vec3 kNeck(-0.8, 0.3, -0.52);  // of a right femur, LPS

Points directions_on_sphere(Index n) {
  Rng rng(5);
  Points directions(n, 3);
  for (Index k = 0; k < n; ++k) directions.row(k) = rng.normal3().normalized();
  return directions;
}

// A right femur in LPS: head of 24 mm about the origin with the departures of `shape` from a
// sphere, neck along kNeck, trochanter at its end.
TriMesh shaped_femur(const HeadShape& shape, double amount) {
  std::vector<Vec2> profile;
  for (double a = 0.03; a < 2.4; a += 0.1)
    profile.emplace_back(-24 * std::cos(a), 24 * std::sin(a));
  for (double x = 20; x < 60; x += 3) profile.emplace_back(x, 15.0 + 0.012 * (x - 20) * (x - 20));
  TriMesh mesh = test::revolved(profile, 48);  // about x
  const Vec3 neck = kNeck.normalized(), y = (Vec3::UnitZ() - neck.z() * neck).normalized();
  Mat3 R;
  R << neck, y, neck.cross(y);
  mesh.points = Points(mesh.points * R.transpose());
  Mat3 axes;
  axes << y.cross(neck), y, neck;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.points.row(v);
    if (p.norm() > 24.5) continue;
    const Points direction = (p.normalized().transpose() * axes).eval();
    const double off = (head_harmonics(direction, shape.degree) * shape.mean)[0];
    mesh.points.row(v) *= 1.0 + amount * off;
  }
  return mesh;
}

// about what real heads have
HeadShape some_shape() {
  HeadShape shape{4, VecX(21), VecX::Constant(3, 0.002), "test"};
  shape.mean << 0.001, 0.0035, 0.002, 0, 0, 0.005, -0.004, -0.003, 0.001, 0.0015, 0, -0.001, 0, 0,
      -0.0065, 0, 0.0015, 0, 0, 0, 0;
  return shape;
}

TriMesh mirrored_in_x(TriMesh mesh) {
  mesh.points.col(0) *= -1.0;
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

TriMesh half_of(const TriMesh& mesh, const Vec3& direction) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Vec3 p = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
    if (p.norm() > 27.0 || p.dot(direction) > 0) kept.push_back(t);
  }
  return sub_mesh(mesh, kept).mesh;
}

JointCentre head_of(const TriMesh& femur, const std::optional<HeadPrior>& prior) {
  SurfaceSet surfaces;
  surfaces["femur"].mesh = femur;
  return find_joint_centre(surfaces, {.start = Vec3(1, -2, 1), .head_prior = prior}).chosen;
}

}  // namespace

TEST(HeadShape, HarmonicsAreOrthonormalOverTheSphere) {
  constexpr Index kDegree = 5;
  const Points directions = directions_on_sphere(40000);
  const MatX Y = head_harmonics(directions, kDegree);
  const MatX gram = Y.transpose() * Y / 40000.0;
  EXPECT_LE((gram - MatX::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 0.04);
  EXPECT_LE(Y.colwise().mean().cwiseAbs().maxCoeff(), 0.03);  // none is a larger radius
  EXPECT_LE((Y.transpose() * directions / 40000.0).cwiseAbs().maxCoeff(), 0.03);  // or a shift
}
TEST(HeadShape, IsLearnedFromHeadsOfBothSides) {
  const HeadShape truth = some_shape();
  const TriMesh right = shaped_femur(truth, 1.0), larger = shaped_femur(truth, 1.5);
  const HeadShape learned = learn_head_shape(
      {{right, Side::right}, {mirrored_in_x(right), Side::left}, {larger, Side::right}});
  // compared where a head is: off the neck
  Points off = directions_on_sphere(500);
  std::vector<Index> kept;
  for (Index k = 0; k < off.rows(); ++k) {
    if (off(k, 2) < 0.3) kept.push_back(k);
  }
  const MatX Y = head_harmonics(off(kept, Eigen::all), 4);
  const VecX difference = 24.0 * Y * (2.0 * learned.mean - 3.5 / 3.0 * truth.mean);
  EXPECT_LE(std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size())), 0.12);
}
TEST(HeadShape, CompletesHalfAHead) {
  const HeadShape shape = some_shape();
  const TriMesh femur = shaped_femur(shape, 1.2);
  const Vec3 whole = head_of(femur, {}).centre;
  for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(0, 1, 0), Vec3(1, 0, 0)}) {
    const TriMesh half = half_of(femur, direction);
    const double plain = (head_of(half, {}).centre - whole).norm();
    const auto completed = head_of(half, HeadPrior{shape, Side::right});
    EXPECT_GE(plain, 0.15) << direction.transpose();
    EXPECT_LE((completed.centre - whole).norm(), 0.5 * plain) << direction.transpose();
    EXPECT_LE((completed.centre - whole).cwiseAbs().maxCoeff(), completed.interval);
    EXPECT_NE(completed.region.find("not in view"), std::string::npos);
    EXPECT_LT(completed.covered_share, 0.6);
  }
}
TEST(HeadShape, TreatsLeftHipsAsMirrorImages) {
  const HeadShape shape = some_shape();
  const TriMesh half = half_of(shaped_femur(shape, 1.2), Vec3::UnitZ());
  SurfaceSet left;
  left["femur"].mesh = mirrored_in_x(half);
  const Vec3 right = head_of(half, HeadPrior{shape, Side::right}).centre;
  const Vec3 found = find_joint_centre(left, {.start = Vec3(-1, -2, 1),
                                              .head_prior = HeadPrior{shape, Side::left}})
                         .chosen.centre;
  EXPECT_LE((found - Vec3(-right.x(), right.y(), right.z())).norm(), 1e-3);
}
TEST(HeadShape, LeavesAWholeHeadAlone) {
  const HeadShape shape = some_shape();
  const TriMesh femur = shaped_femur(shape, -1.0);
  const auto plain = head_of(femur, {}), completed = head_of(femur, HeadPrior{shape, Side::right});
  EXPECT_EQ(plain.centre, completed.centre);
  EXPECT_EQ(plain.interval, completed.interval);
  EXPECT_EQ(plain.region, completed.region);
}
TEST(HeadShape, LeavesABumpAlone) {
  const HeadShape shape = some_shape();
  TriMesh femur = shaped_femur(shape, 1.0);
  const Vec3 top = Vec3(0.5, -0.6, 0.62).normalized();
  for (Index v = 0; v < femur.n_vertices(); ++v) {
    const Vec3 p = femur.points.row(v);
    if (p.norm() < 25.0 && p.normalized().dot(top) > 0.75) femur.points.row(v) *= 1.18;
  }
  EXPECT_EQ(head_of(femur, {}).centre, head_of(femur, HeadPrior{shape, Side::right}).centre);
}
TEST(HeadShape, IsBitIdenticalForOneAndEightThreads) {
  const HeadShape shape = some_shape();
  const TriMesh half = half_of(shaped_femur(shape, 1.2), Vec3::UnitZ());
  const auto run = [&] {
    const auto head = head_of(half, HeadPrior{shape, Side::right});
    return std::vector<double>{head.centre.x(), head.centre.y(), head.centre.z(), head.interval};
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(HeadShape, RefusesWhatDoesNotFit) {
  HeadShape shape = some_shape();
  shape.mean.conservativeResize(20);
  EXPECT_THROW(check_head_shape(shape), Error);
  shape = some_shape();
  shape.spread[1] = 0.0;
  EXPECT_THROW(check_head_shape(shape), Error);
  EXPECT_THROW(learn_head_shape({{test::revolved({{0, 1}, {1, 1}}, 12), Side::right}}), Error);
}

}  // namespace coxa::motion
