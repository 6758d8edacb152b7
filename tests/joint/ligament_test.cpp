#include <coxa/joint/live.h>
#include <coxa/joint/simulate.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "../../src/joint/ligament_force.h"
#include "dynamics/witness.h"
#include "joint/layers.h"
#include "joint/movements.h"

namespace coxa::joint {
namespace {

const JointModel hip = test::make_ball_in_cup({.cup_rings = 6, .head_rings = 8, .layers = 1});
const JointOptions quick = {.centre_shift = std::nullopt};

FrameResult at_rest(const JointModel& model, const LoadCase& load) {
  return simulate(model, test::movement_to({}, 1), load, quick).frames[0];
}
JointModel with(std::vector<Ligament> ligaments) {
  JointModel model = hip;
  model.ligaments = std::move(ligaments);
  return model;
}
/// Length of the shortest path outside a sphere about the origin: over all pairs of points where it
/// may touch the sphere, on the great circle through both ends.
double searched_length(const Vec3& from, const Vec3& to, double radius) {
  constexpr int kPlaces = 500;
  const Vec3 e1 = from.normalized(), e2 = from.cross(to).normalized().cross(e1);
  const double turn = std::atan2(to.dot(e2), to.dot(e1));
  const auto on_sphere = [&](int k) {
    const double at = turn * k / kPlaces;
    return Vec3(radius * (std::cos(at) * e1 + std::sin(at) * e2));
  };
  const auto seen = [](const Vec3& end, const Vec3& p) { return (end - p).dot(p) > -1e-9; };
  double best = kInfinity;
  for (int i = 0; i <= kPlaces; ++i) {
    if (!seen(from, on_sphere(i))) continue;
    for (int j = i; j <= kPlaces; ++j) {
      if (!seen(to, on_sphere(j))) continue;
      const double around = radius * turn * (j - i) / kPlaces;
      best = std::min(best, (from - on_sphere(i)).norm() + around + (to - on_sphere(j)).norm());
    }
  }
  return best;
}

}  // namespace

TEST(LigamentPath, GoesStraightWhereTheSphereIsNotInTheWay) {
  const Vec3 a(30, 0, 0), b(0, 30, 0);
  EXPECT_NEAR(ligament_path(a, b, Vec3::Zero(), 0.0).length, 30.0 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(ligament_path(a, b, Vec3::Zero(), 21.0).length, 30.0 * std::sqrt(2.0), 1e-12);
}
TEST(LigamentPath, GoesAroundTheSphereTheShortestWay) {
  const Vec3 centre(1, 2, 3);
  for (const auto& [a, b, r] : {std::tuple{Vec3(30, 0, 5), Vec3(-10, 28, 3), 24.0},
                                std::tuple{Vec3(26, 1, 0), Vec3(-25, 9, 20), 25.0}}) {
    const LigamentPath path = ligament_path(centre + a, centre + b, centre, r);
    EXPECT_NEAR(path.length, searched_length(a, b, r), 1e-3 * path.length);
    EXPECT_NEAR(path.length, ligament_path(centre + b, centre + a, centre, r).length, 1e-12);
    EXPECT_GT(path.length, (a - b).norm());
  }
}
TEST(LigamentPath, HasTheSlopeAndCurvatureOfItsLength) {
  const Vec3 insertion(-10, 28, 3), centre(1, 2, 3);
  constexpr double kStep = 1e-5;
  for (const double radius : {0.0, 24.0}) {
    const Vec3 origin(30, 0, 5);
    const auto slope_at = [&](const Vec3& at) {
      return ligament_path(at, insertion, centre, radius).towards_origin;
    };
    const LigamentPath path = ligament_path(origin, insertion, centre, radius);
    EXPECT_NEAR(path.towards_origin.norm(), 1.0, 1e-12);
    for (int c = 0; c < 3; ++c) {
      const Vec3 step = kStep * Vec3::Unit(c);
      const double slope = (ligament_path(origin + step, insertion, centre, radius).length -
                            ligament_path(origin - step, insertion, centre, radius).length) /
                           (2.0 * kStep);
      EXPECT_NEAR(path.towards_origin[c], slope, 1e-8);
      const Vec3 bend = (slope_at(origin + step) - slope_at(origin - step)) / (2.0 * kStep);
      EXPECT_LE((path.curvature.col(c) - bend).norm(), 1e-8);
    }
  }
}
TEST(LigamentForce, HasTheForceOfItsEnergyAndItsJacobian) {
  const LigamentForce force({{"straight", {30, 0, 5}, {}, 20.0, 30.0, 0.0},
                             {"wrapped", {30, 0, 5}, {}, 30.0, 40.0, 24.0},
                             {"slack", {30, 0, 5}, {}, 30.0, 400.0, 0.0}},
                            0, 3, 4);
  VecX x(15);
  x << -10, 28, 3, -12, 27, 4, 0, 30, 0, 1, 2, 3, 0.4, -0.3, 0.2;
  VecX numeric = dynamics::test::numeric_force(force, x, 1e-5);
  numeric.head<12>().setZero();  // only the translation is free
  const VecX given = dynamics::test::force_at(force, x, VecX());
  EXPECT_GT(given.norm(), 100.0);
  EXPECT_LE((given - numeric).norm(), 1e-7 * given.norm());
  const Mat3 wanted = dynamics::test::numeric_stiffness(force, x, VecX()).block<3, 3>(12, 12);
  const Mat3 K = dynamics::test::given_stiffness(force, x, VecX()).block<3, 3>(12, 12);
  EXPECT_LE((K - wanted).norm(), 1e-6 * wanted.norm());
  EXPECT_EQ(force.tensions(x)[2], 0.0);
  EXPECT_EQ(Vec3(force.pull(x)), Vec3(given.segment<3>(12)));
}

TEST(Ligaments, PullTheHeadIntoTheSocketLikeAForce) {
  // straight up from the joint centre, so long that its stretch hardly changes: a dead load
  const double length = 1e4, force = 200.0;
  const Ligament up{"up", {0, 0, length}, {0, 0, 0}, 1.0, length - force, 0.0};
  const FrameResult pulled = at_rest(with({up}), constant_force(300.0, Vec3(0, 1, 0)));
  const FrameResult pressed = at_rest(hip, constant_force(500.0, Vec3(0, 1, 0)));
  ASSERT_EQ(pulled.status, FrameStatus::converged) << pulled.reason;
  ASSERT_EQ(pulled.ligament_tension.size(), 1);
  EXPECT_NEAR(pulled.ligament_tension[0], force, 0.5);
  EXPECT_LT((pulled.balance.ligament_force - Vec3(0, 0, force)).norm(), 0.5);
  EXPECT_NEAR(pulled.balance.contact_force.norm(), 500.0, 1.0);
  EXPECT_NEAR(pulled.contact.peak_pressure_p99, pressed.contact.peak_pressure_p99,
              0.01 * pressed.contact.peak_pressure_p99);
  EXPECT_LT(pulled.balance.force_error, 1e-3);
  EXPECT_LT(pulled.balance.reaction_error, 1e-3);
}
TEST(Ligaments, ChangeNothingWhileSlack) {
  const LoadCase load = passive_examination(hip, 500.0);
  const auto motion = test::movement_to({radians(5.0), 0.0, 0.0}, 2);
  const Ligament loose{"loose", {20, 0, 40}, {0, 20, -30}, 50.0, 500.0, 0.0};
  const JointResult without = simulate(hip, motion, load, quick),
                    slack = simulate(with({loose}), motion, load, quick);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(slack.frames[k].ligament_tension, VecX(VecX::Zero(1)));
    // sums over longer vectors are rounded otherwise
    EXPECT_LE((slack.frames[k].acetabular_displacement - without.frames[k].acetabular_displacement)
                  .norm(),
              1e-6);
    EXPECT_NEAR(slack.frames[k].balance.elastic_energy, without.frames[k].balance.elastic_energy,
                1e-6);
    EXPECT_EQ(without.frames[k].ligament_tension.size(), 0);
  }
}
TEST(Ligaments, TightenAsTheFemurTurns) {
  // from 40 mm above the centre to a point 30 mm in front: flexion brings it nearer, extension
  // takes it away; the head hardly moves
  const double slack = 50.0;
  const Ligament front{"front", {0, 0, 40}, {0, -30, 0}, 2.0, slack, 0.0};
  for (const double flexion : {-20.0, 0.0, 20.0}) {
    const auto motion = test::movement_to({radians(flexion), 0.0, 0.0}, 3);
    const FrameResult frame =
        simulate(with({front}), motion, passive_examination(hip, 500.0), quick).frames[2];
    ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
    const double angle = radians(90.0 - flexion);
    const double length = std::sqrt(1600.0 + 900.0 - 2400.0 * std::cos(angle));
    EXPECT_NEAR(frame.ligament_tension[0], 2.0 * std::max(0.0, length - slack), 0.2) << flexion;
  }
}
TEST(Ligaments, HoldAHeadThatAForceWouldTakeOutOfItsSocket) {
  // a force across the socket's axis: the head rides over the rim, unless a band holds it
  const LoadCase across = constant_force(300.0, Vec3(1.0, -0.6, 0.0));
  EXPECT_EQ(at_rest(hip, across).status, FrameStatus::failed);
  // back and up: anterior is -y
  const Ligament back{"back", {0, 60, 60}, {0, 0, 0}, 100.0, 60.0 * std::sqrt(2.0), 0.0};
  const FrameResult held = at_rest(with({back}), across);
  ASSERT_EQ(held.status, FrameStatus::converged) << held.reason;
  EXPECT_GT(held.ligament_tension[0], 200.0);
  EXPECT_LT(held.balance.force_error, 1e-3);
}
TEST(Ligaments, AreFeltByALiveHip) {
  const Ligament up{"up", {0, 0, 1e4}, {0, 0, 0}, 1.0, 1e4 - 200.0, 0.0};
  const JointModel model = with({up});
  LiveHip live(model, constant_force(300.0, Vec3(0, 1, 0)));
  const FrameResult frame = live.settle().frame;
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_NEAR(frame.balance.contact_force.norm(), 500.0, 1.0);
}
TEST(Ligaments, AreBitIdenticalForOneAndEightThreads) {
  const JointModel model = with({{"a", {0, 20, 40}, {0, -30, 0}, 5.0, 40.0, 0.0},
                                 {"b", {0, 30, 5}, {0, -30, 5}, 5.0, 40.0, 26.6}});
  const auto all = [&] {
    const FrameResult frame = at_rest(model, passive_examination(hip, 500.0));
    EXPECT_GT(frame.ligament_tension.minCoeff(), 1.0);
    return VecX(frame.femoral_pressure.array() + frame.ligament_tension.sum());
  };
  EXPECT_EQ(with_threads(1, all), with_threads(8, all));
}
TEST(Ligaments, SayWhatIsWrongWithThem) {
  const Ligament good{"good", {0, 0, 40}, {0, -30, 0}, 2.0, 50.0, 0.0};
  const auto fault = [&](const std::function<void(Ligament&)>& spoil) -> std::string {
    JointModel model = with({good, good});
    model.ligaments[1].name = "other";
    spoil(model.ligaments[1]);
    try {
      check_model(model);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const auto holds = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(fault([](Ligament&) {}), "nothing");
  holds(fault([](Ligament& l) { l.name = "a,b"; }), "letters, digits and underscores, got \"a,b\"");
  holds(fault([](Ligament& l) { l.name = "good"; }), "two ligaments are called good");
  holds(fault([](Ligament& l) { l.stiffness = 0.0; }), "other: stiffness must be positive, got 0");
  holds(fault([](Ligament& l) { l.slack_length = -1.0; }), "slack length must be positive, got -1");
  holds(fault([](Ligament& l) { l.wrap_radius = -1.0; }), "must not be negative, got -1 mm");
  holds(fault([](Ligament& l) { l.wrap_radius = 31.0; }),
        "an end lies 30 mm from the joint centre");
  holds(fault([](Ligament& l) { l.insertion = l.origin; }), "are one point");
}

}  // namespace coxa::joint
