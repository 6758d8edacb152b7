// A soft labrum: a ring of elastic tissue beyond the cup's rim, into which the head presses.
#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/joint/simulate.h>

#include <gtest/gtest.h>

#include "joint/layers.h"
#include "joint/movements.h"
#include "support/shapes.h"

namespace coxa::joint {
namespace {

constexpr double kRadius = 25.0;  // mm, of head and cup
constexpr Index kAround = 40, kAlong = 3;

/// Part of a ring about the cup's axis, from polar angle 61 to 75 degrees and from longitude `from`
/// to `to`; its inside overlaps the head by 0.03 mm, its outside is the seat.
TetMesh ring(double from, double to) {
  const auto sheet = [&](double radius) {
    Points points((kAround + 1) * (kAlong + 1), 3);
    for (Index k = 0; k <= kAround; ++k)
      for (Index j = 0; j <= kAlong; ++j) {
        const double turn = from + (to - from) * k / kAround;
        const double polar = radians(61.0 + 14.0 * j / kAlong);
        points.row(k * (kAlong + 1) + j) << radius * std::sin(polar) * std::cos(turn),
            radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar);
      }
    return points;
  };
  Triangles triangles(2 * kAround * kAlong, 3);
  Index row = 0;
  for (Index k = 0; k < kAround; ++k)
    for (Index j = 0; j < kAlong; ++j) {
      const Index a = k * (kAlong + 1) + j, b = a + kAlong + 1;
      triangles.row(row++) << a, a + 1, b + 1;
      triangles.row(row++) << a, b + 1, b;
    }
  return test::layered_mesh({sheet(kRadius + 3.0), sheet(kRadius + 1.4), sheet(kRadius - 0.03)},
                            triangles);
}

JointModel with_ring(const TetMesh& labrum, double modulus = kLabrumMaterial.youngs_modulus) {
  JointModel model = test::make_ball_in_cup({});
  model.labrum_body = labrum;
  model.labrum_material.youngs_modulus = modulus;
  return model;
}
const TetMesh whole = ring(-kPi, kPi), part = ring(radians(-30.0), radians(100.0));

FrameResult pressed(const JointModel& model) {
  const auto motion = test::movement_to({0.0, 0.0, 0.0}, 1);
  // along the cup's axis whatever bears
  return simulate(model, motion, constant_force(500.0, Vec3(0, 1, 0)),
                  {.centre_shift = std::nullopt})
      .frames[0];
}

TEST(LabrumBody, TakesAShareOfTheForceAndHandsItToTheBone) {
  const FrameResult frame = pressed(with_ring(whole));
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  const BalanceFigures& balance = frame.balance;
  const Vec3 along = Vec3::UnitZ();
  EXPECT_NEAR(balance.contact_force.dot(along), 500.0, 0.5);
  const double on_labrum = balance.force_on_labrum.dot(along);
  EXPECT_GT(on_labrum, 10.0);
  EXPECT_NEAR(frame.labrum.force_share, on_labrum / 500.0, 0.01);
  EXPECT_NEAR(balance.labrum_reaction.dot(along), on_labrum, 0.5);
  EXPECT_NEAR(balance.socket_reaction.dot(along), 500.0 - on_labrum, 0.5);
  EXPECT_LT(balance.force_error, 1e-3);
  EXPECT_LT(balance.reaction_error, 1e-3);
  EXPECT_LE(frame.contact.penetration, 0.01);
  // 0.03 mm of overlap and what the head comes nearer, over 3 mm of tissue
  EXPECT_NEAR(frame.labrum.strain, 0.012, 0.008);
  EXPECT_GT(frame.labrum.peak_strain_p99, frame.labrum.strain);
  EXPECT_GT(frame.labrum.peak_pressure_p99, 0.1);
  const double area =
      2.0 * kPi * kRadius * kRadius * (std::cos(radians(61.0)) - std::cos(radians(75.0)));
  EXPECT_NEAR(frame.labrum.contact_area, area, 0.2 * area);
  ASSERT_EQ(frame.labrum_displacement.rows(), whole.n_vertices());
  EXPECT_EQ(frame.labrum_pressure.size(), whole.n_vertices());
}
TEST(LabrumBody, WithoutStiffnessLeavesTheJointAsItIsWithoutIt) {
  const FrameResult without = pressed(test::make_ball_in_cup({}));
  const FrameResult soft = pressed(with_ring(whole, 0.05));
  ASSERT_EQ(soft.status, FrameStatus::converged) << soft.reason;
  EXPECT_LT(soft.labrum.force_share, 2e-3);
  EXPECT_NEAR(soft.contact.peak_pressure_p99, without.contact.peak_pressure_p99, 5e-3);
  EXPECT_NEAR(soft.translation.z(), without.translation.z(), 1e-3);
  const FrameResult stiff = pressed(with_ring(whole, 40.0));
  EXPECT_GT(stiff.labrum.force_share, 1.2 * pressed(with_ring(whole)).labrum.force_share);
}
TEST(LabrumBody, IsTheSameInTheMirror) {
  const FrameResult right = pressed(with_ring(part));
  TetMesh mirrored = part;
  mirrored.points.col(0) *= -1.0;
  for (Index t = 0; t < mirrored.n_tets(); ++t) std::swap(mirrored.tets(t, 2), mirrored.tets(t, 3));
  for (Index f = 0; f < mirrored.facets.rows(); ++f)
    std::swap(mirrored.facets(f, 1), mirrored.facets(f, 2));
  // the ball and the cup are their own mirror images but for how their facets are cut
  const FrameResult left = pressed(with_ring(mirrored));
  ASSERT_EQ(right.status, FrameStatus::converged) << right.reason;
  ASSERT_EQ(left.status, FrameStatus::converged) << left.reason;
  EXPECT_NEAR(left.labrum.force_share, right.labrum.force_share, 0.02 * right.labrum.force_share);
  EXPECT_NEAR(left.translation.x(), -right.translation.x(), 2e-3);
  EXPECT_NEAR(left.translation.y(), right.translation.y(), 2e-3);
  EXPECT_NEAR(left.labrum.strain, right.labrum.strain, 0.02 * right.labrum.strain);
}
TEST(LabrumBody, IsBitIdenticalForOneAndEightThreads) {
  const JointModel model = with_ring(part);
  const auto run = [&] {
    const FrameResult frame = pressed(model);
    EXPECT_EQ(frame.status, FrameStatus::converged);
    return Points(frame.labrum_displacement);
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(LabrumBody, IsHeldByTheBoneItLiesOnWhereNoFacetSaysWhatHoldsIt) {
  JointModel model = with_ring(whole);
  const FrameResult tagged = pressed(model);
  model.labrum_body.facet_tags.assign(model.labrum_body.facet_tags.size(), FacetTag::rim);
  try {
    check_model(model);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nothing holds the labrum"), std::string::npos);
  }
  // a hollow in the bone of the radius of the ring's outside
  model.hip_bone = test::turned_over(test::icosphere(5, kRadius + 3.0, Vec3::Zero()));
  model.femur = test::icosphere(2, 5.0, Vec3::Zero());
  const FrameResult held = pressed(model);
  ASSERT_EQ(held.status, FrameStatus::converged) << held.reason;
  EXPECT_NEAR(held.labrum.force_share, tagged.labrum.force_share, 0.01 * tagged.labrum.force_share);
}
TEST(LabrumBody, HasStressFields) {
  const JointModel model = with_ring(part);
  const FrameResult frame = pressed(model);
  const StressFields fields = labrum_fields(model, frame);
  EXPECT_EQ(fields.von_mises.size(), part.n_tets());
  EXPECT_GT(fields.von_mises.maxCoeff(), 0.1);
  EXPECT_THROW(labrum_fields(test::make_ball_in_cup({}), frame), Error);
}

}  // namespace
}  // namespace coxa::joint
