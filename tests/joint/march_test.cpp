#include "../../src/joint/march.h"

#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <gtest/gtest.h>

#include "joint/layers.h"

namespace coxa::joint {
namespace {

JointModel small_hip(MaterialLaw law = MaterialLaw::corotational) {
  // the head sits beside the middle, so that the way to a pose is no pure turn of a ball
  JointModel model = test::make_ball_in_cup(
      {.gap = 0.3, .cup_rings = 6, .head_rings = 8, .layers = 1, .head_offset = Vec3(0.2, 0, 0)});
  model.material.law = law;
  return model;
}
BonePose flexed(double angle) {
  return {rotation_from_vector(Vec3(angle, 0.0, 0.0)), Vec3::Zero()};
}
const Vec3 kInto(0.0, 0.0, 400.0);  // N

/// A hip that rests under the joint force in the image pose.
struct Hip {
  explicit Hip(const JointModel& hip, const JointOptions& hip_options = {})
      : model(hip),
        options(hip_options),
        system(model),
        march(system, LoadMode::force, options),
        state{system.reference(),
              {},
              system.make_contact(options.contact_stiffness, options.max_translation)} {}
  void rest() {
    ASSERT_EQ(march.equilibrium().seat(state, kInto), "");
    ASSERT_TRUE(march.advance(state, {}, kInto, {}).converged);
  }
  Vec3 found() const { return state.x.segment<3>(3 * system.translation()); }

  JointModel model;
  JointOptions options;
  HipSystem system;
  March march;
  HipState state;
};

}  // namespace

TEST(StartAnew, FindsTheEquilibriumThatTheWayLeadsTo) {
  const JointOptions exact{.residual_tolerance = 1e-7};
  Hip along(small_hip(), exact), anew(small_hip(), exact);
  along.rest();
  anew.rest();
  const BonePose target = flexed(radians(8.0));
  ASSERT_TRUE(along.march.advance(along.state, target, kInto, {}).converged);
  const Settling settling = anew.march.start_anew(anew.state, target, kInto, {});
  ASSERT_TRUE(settling.converged) << settling.reason;
  EXPECT_GT(settling.iterations, 0);
  EXPECT_EQ(anew.state.pose.R, target.R);
  // both overlap by up to the tolerance of 0.01 mm
  EXPECT_LT((along.found() - anew.found()).norm(), 0.01);
  EXPECT_LT((along.state.x - anew.state.x).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT((anew.state.contact.force(anew.state.x) - kInto).norm(), 1e-4 * kInto.norm());
}
TEST(StartAnew, DoesNotSeeWhatTheStateHasBecome) {
  Hip clean(small_hip()), spoilt(small_hip());
  clean.rest();
  spoilt.rest();
  Rng rng(3);
  for (Index i = 0; i < 3 * spoilt.system.translation(); ++i) spoilt.state.x[i] += rng.normal();
  ASSERT_TRUE(clean.march.start_anew(clean.state, flexed(0.1), kInto, {}).converged);
  ASSERT_TRUE(spoilt.march.start_anew(spoilt.state, flexed(0.1), kInto, {}).converged);
  EXPECT_EQ(clean.state.x, spoilt.state.x);
}
TEST(StartAnew, FindsAPoseToWhichNoWayLeads) {
  // a node pushed through its element: a neo-Hookean body has no energy there to go down from
  Hip hip(small_hip(MaterialLaw::neo_hookean), {.max_cutbacks = 1});
  hip.rest();
  const std::vector<bool> free = hip.system.free_particles(LoadMode::force);
  Index node = 0;
  while (!free[static_cast<std::size_t>(node)]) ++node;
  hip.state.x.segment<3>(3 * node) += Vec3(0.0, 0.0, 5.0);
  const HipState spoilt = hip.state;
  const Settling along = hip.march.advance(hip.state, flexed(0.05), kInto, {});
  ASSERT_FALSE(along.converged);
  EXPECT_NE(along.reason.find("no equilibrium"), std::string::npos) << along.reason;
  EXPECT_EQ(hip.state.x, spoilt.x);
  const Settling anew = hip.march.start_anew(hip.state, flexed(0.05), kInto, {});
  EXPECT_TRUE(anew.converged) << anew.reason;
}
TEST(StartAnew, CountsTheSameWorkAsOneStepOfTheWay) {
  const JointOptions exact{.residual_tolerance = 1e-7};
  Hip along(small_hip(), exact), anew(small_hip(), exact);
  along.rest();
  anew.rest();
  const double before = along.march.work();
  ASSERT_EQ(before, anew.march.work());
  const Vec3 more = 1.5 * kInto;  // sinks in deeper
  ASSERT_TRUE(along.march.advance(along.state, flexed(0.02), more, {}).converged);
  ASSERT_TRUE(anew.march.start_anew(anew.state, flexed(0.02), more, {}).converged);
  const double work = along.march.work() - before;
  EXPECT_GT(work, 1.0);
  EXPECT_NEAR(anew.march.work() - before, work, 0.05 * work);
}
TEST(StartAnew, LeavesTheStateAloneWhereTheHeadFindsNoSeat) {
  Hip hip(small_hip());
  hip.rest();
  const HipState before = hip.state;
  const double work = hip.march.work();
  const Settling settling = hip.march.start_anew(hip.state, flexed(0.1), -kInto, {});
  EXPECT_FALSE(settling.converged);
  EXPECT_NE(settling.reason.find("nothing to press against"), std::string::npos) << settling.reason;
  EXPECT_EQ(hip.state.x, before.x);
  EXPECT_EQ(hip.state.pose.R, before.pose.R);
  EXPECT_EQ(hip.march.work(), work);
}
TEST(StartAnew, LeavesTheStateAloneWhereNothingSettles) {
  Hip hip(small_hip());
  hip.rest();
  hip.options.max_contact_updates = 1;
  hip.options.max_newton_iterations = 1;
  const HipState before = hip.state;
  const Settling settling = hip.march.start_anew(hip.state, flexed(0.1), kInto, {});
  EXPECT_FALSE(settling.converged);
  EXPECT_NE(settling.reason.find("no equilibrium after 1 Newton steps"), std::string::npos)
      << settling.reason;
  EXPECT_EQ(hip.state.x, before.x);
}

}  // namespace coxa::joint
