#include <coxa/collide/surface_contact.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "collide/shapes.h"

namespace coxa::collide {

const TriMesh ball = test::icosphere(2, 10.0, Vec3(0, 0, 0));
const TriMesh other_ball = test::icosphere(3, 10.0, Vec3(0.3, 0.4, 18.5));

using Kind = std::pair<ContactNormal, ContactRule>;

/// Two overlapping balls of particles, slightly shaken.
SurfaceContact ball_contact(const Kind& kind) {
  return SurfaceContact(make_particle_surface(ball.triangles),
                        make_particle_surface(test::after(ball, other_ball)),
                        {.stiffness = 50.0, .normal = kind.first, .rule = kind.second});
}
const VecX ball_x = test::shaken(test::stacked(ball, other_ball), 0.01);

VecX force_of(const SurfaceContact& contact, const VecX& x) {
  VecX force = VecX::Zero(x.size());
  contact.add_force(x, VecX::Zero(x.size()), force);
  return force;
}

class SurfaceContactKinds : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, SurfaceContactKinds,
                         testing::Values(Kind{ContactNormal::nearest, ContactRule::pointwise},
                                         Kind{ContactNormal::smooth, ContactRule::pointwise},
                                         Kind{ContactNormal::nearest, ContactRule::nodal},
                                         Kind{ContactNormal::smooth, ContactRule::nodal}));

TEST_P(SurfaceContactKinds, ForceIsTheSlopeOfTheEnergy) {
  SurfaceContact contact = ball_contact(GetParam());
  contact.update_pairs(ball_x);
  contact.update_multipliers(ball_x);
  const VecX force = force_of(contact, ball_x);
  ASSERT_GT(force.norm(), 1.0);
  const double step = 1e-5;
  for (Index i = 0; i < ball_x.size(); ++i) {
    if (i % 7 != 0 && force[i] == 0.0) continue;
    VecX ahead = ball_x, behind = ball_x;
    ahead[i] += step;
    behind[i] -= step;
    const double slope = (contact.energy(ahead) - contact.energy(behind)) / (2.0 * step);
    EXPECT_NEAR(-slope, force[i], 1e-5 * force.lpNorm<Eigen::Infinity>());
  }
}

TEST_P(SurfaceContactKinds, JacobianIsTheSlopeOfTheForce) {
  SurfaceContact contact = ball_contact(GetParam());
  contact.update_pairs(ball_x);
  const Index n = static_cast<Index>(ball_x.size() / 3);
  solve::BlockMatrix A(n, contact.pattern());
  A.set_zero();
  contact.add_jacobian(ball_x, VecX::Zero(ball_x.size()), 2.0, 0.0, A);
  Rng rng(3);
  VecX direction(ball_x.size()), product;
  for (double& value : direction) value = rng.normal();
  A.multiply(direction, product);
  const double step = 1e-7;
  const VecX difference = (force_of(contact, ball_x + step * direction) -
                           force_of(contact, ball_x - step * direction)) /
                          (2.0 * step);
  EXPECT_LE((product + 2.0 * difference).norm(), 1e-5 * product.norm());
}

TEST_P(SurfaceContactKinds, ForceAndMomentBalance) {
  SurfaceContact contact = ball_contact(GetParam());
  contact.update_pairs(ball_x);
  const VecX force = force_of(contact, ball_x);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero(), on_slave = Vec3::Zero();
  for (Index i = 0; i < ball_x.size() / 3; ++i) {
    sum += force.segment<3>(3 * i);
    moment += ball_x.segment<3>(3 * i).cross(Vec3(force.segment<3>(3 * i)));
    if (i < ball.n_vertices()) on_slave += force.segment<3>(3 * i);
  }
  EXPECT_LT(on_slave.z(), -1.0);
  EXPECT_LE(sum.norm(), 1e-12 * on_slave.norm());
  EXPECT_LE(moment.norm(), 1e-12 * on_slave.norm() * 20.0);
}

TEST_P(SurfaceContactKinds, AreBitIdenticalForOneAndEightThreads) {
  const auto run = [&] {
    SurfaceContact contact = ball_contact(GetParam());
    contact.update_pairs(ball_x);
    return force_of(contact, ball_x);
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

/// Total upward force on a plate of side 10 sunk 0.02 mm into an obstacle facing up.
double plate_force(Index n, const ContactOptions& options) {
  const TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, n));
  const TriMesh floor = test::plate(0.0, 7.0, 3);
  SurfaceContact contact(make_particle_surface(plate.triangles), floor, options);
  const VecX x = test::stacked(plate);
  contact.update_pairs(x);
  const VecX force = force_of(contact, x);
  double sum = 0.0;
  for (Index i = 2; i < force.size(); i += 3) sum += force[i];
  return sum;
}

TEST(SurfaceContact, PressureDoesNotDependOnMeshOrQuadrature) {
  const double exact = 100.0 * 0.02 * 100.0;  // stiffness, depth, area
  for (const auto quadrature : {ContactQuadrature::vertices, ContactQuadrature::three_points,
                                ContactQuadrature::six_points}) {
    for (const auto rule : {ContactRule::pointwise, ContactRule::nodal}) {
      for (const Index n : {1, 4, 9}) {
        EXPECT_NEAR(plate_force(n, {.quadrature = quadrature, .rule = rule}), exact, 1e-9 * exact);
      }
    }
  }
}
TEST(SurfaceContact, StiffnessAndMinimumGapRaiseThePressure) {
  EXPECT_NEAR(plate_force(4, {.stiffness = 300.0}), 600.0, 1e-9);
  EXPECT_NEAR(plate_force(4, {.minimum_gap = 0.05}), 700.0, 1e-9);
}
TEST(SurfaceContact, PairsNothingBeyondTheSearchDistance) {
  EXPECT_GT(plate_force(4, {.search_distance = 0.021}), 0.0);
  EXPECT_EQ(plate_force(4, {.search_distance = 0.019}), 0.0);
}
TEST(SurfaceContact, PairsOnlySurfacesThatFaceEachOther) {
  const TriMesh same_way = test::plate(-0.02, 5.0, 2), floor = test::plate(0.0, 5.0, 3);
  for (const auto& [facing, count] : {std::pair{-1.0, 24}, std::pair{0.5, 0}}) {
    SurfaceContact contact(make_particle_surface(same_way.triangles), floor, {.facing = facing});
    contact.update_pairs(test::stacked(same_way));
    EXPECT_EQ(contact.constraints().size(), static_cast<std::size_t>(count));
  }
}
TEST(SurfaceContact, TurnsAwayLittleByLittle) {
  const TriMesh floor = test::plate(0.0, 20.0, 3);
  double last = kInfinity;
  for (double facing = 0.95; facing > 0.1; facing -= 0.05) {
    const double tilt = std::acos(facing);
    TriMesh plate = test::turned_over(test::plate(0.0, 1.0, 2));
    plate.points = plate.points * Eigen::AngleAxisd(tilt, Vec3::UnitX()).matrix().transpose();
    plate.points.col(2).array() -= 1.5;  // wholly below the floor
    SurfaceContact contact(make_particle_surface(plate.triangles), floor,
                           {.facing = 0.2, .facing_fully = 0.6});
    contact.update_pairs(test::stacked(plate));
    double area = 0.0;
    for (const ContactConstraint& constraint : contact.constraints()) area += constraint.area;
    EXPECT_NEAR(area, 4.0 * std::clamp((facing - 0.2) / 0.4, 0.0, 1.0), 1e-9) << facing;
    EXPECT_LE(area, last + 1e-12);
    last = area;
  }
  EXPECT_EQ(last, 0.0);
}
TEST(SurfaceContact, SmoothNormalsNeverLeadFarFromTheSurface) {
  // a ring of so few facets that its normals turn by a right angle from corner to corner
  const TriMesh ring = test::torus(5.0, 1.0, 7, 4);
  const TriMesh cloud = test::icosphere(4, 3.5, Vec3(0.1, 0.2, 0.3));
  const VecX x = test::stacked(cloud);
  SurfaceContact contact(make_particle_surface(cloud.triangles), ring,
                         {.search_distance = 4.0, .normal = ContactNormal::smooth});
  contact.update_pairs(x);
  ASSERT_GT(contact.constraints().size(), 1000u);
  for (const ContactConstraint& constraint : contact.constraints())
    EXPECT_LE(std::abs(contact.gap(constraint, x)), 6.0);  // 1.5 times the search distance
}
TEST(SurfaceContact, DoesNotPairWhatLiesBeyondAnOpenBorder) {
  TriMesh half = test::turned_over(test::plate(-0.02, 5.0, 20));
  half.points.col(0).array() += 5.05;  // half of it past the floor's border at x = 5
  const TriMesh floor = test::plate(0.0, 5.0, 3);
  for (const auto normal : {ContactNormal::nearest, ContactNormal::smooth}) {
    SurfaceContact contact(make_particle_surface(half.triangles), floor, {.normal = normal});
    contact.update_pairs(test::stacked(half));
    for (const ContactSample& sample : contact.samples(test::stacked(half))) {
      EXPECT_EQ(sample.pressure > 0.0, sample.point.x() < 5.0) << sample.point.x();
    }
  }
}
TEST(SurfaceContact, IsPushedOutOfAClosedObstacle) {
  const TriMesh inner = test::icosphere(1, 1.0, Vec3(0, 0, 9.5));
  SurfaceContact contact(make_particle_surface(inner.triangles), ball, {});
  const VecX x = test::stacked(inner);
  contact.update_pairs(x);
  const VecX force = force_of(contact, x);
  double up = 0.0;
  for (Index i = 2; i < force.size(); i += 3) up += force[i];
  EXPECT_GT(up, 0.0);
}
TEST(SurfaceContact, FollowsAMovedObstacle) {
  const TriMesh plate = test::turned_over(test::plate(0.5, 5.0, 2)),
                floor = test::plate(0.0, 5.0, 3);
  SurfaceContact contact(make_particle_surface(plate.triangles), floor, {});
  const VecX x = test::stacked(plate);
  contact.update_pairs(x);
  EXPECT_EQ(contact.energy(x), 0.0);
  Points raised = floor.points;
  raised.col(2).array() += 0.6;
  contact.update_obstacle(raised);
  contact.update_pairs(x);
  EXPECT_NEAR(contact.energy(x), 0.5 * 100.0 * 0.1 * 0.1 * 100.0, 1e-9);
  EXPECT_THROW(contact.update_obstacle(Points(raised.topRows(3))), Error);
}
TEST(SurfaceContact, MultipliersCarryTheLoadAtZeroPenetration) {
  const TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, 2)),
                floor = test::plate(0.0, 5.0, 3);
  SurfaceContact contact(make_particle_surface(plate.triangles), floor, {});
  VecX x = test::stacked(plate);
  contact.update_pairs(x);
  EXPECT_NEAR(contact.update_multipliers(x), 0.02, 1e-12);
  for (Index i = 2; i < x.size(); i += 3) x[i] = 0.0;
  EXPECT_NEAR(contact.pressure(contact.constraints().front(), x), 2.0, 1e-12);
  contact.clear_multipliers();
  EXPECT_EQ(contact.pressure(contact.constraints().front(), x), 0.0);
}
TEST(SurfaceContact, OverlapThatDoesNotHalveStiffensItsConstraint) {
  const TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, 2)),
                floor = test::plate(0.0, 5.0, 3);
  SurfaceContact contact(make_particle_surface(plate.triangles), floor, {});
  VecX x = test::stacked(plate);
  contact.update_pairs(x);
  const auto stiffness = [&] { return contact.stiffness(contact.constraints().front()); };
  contact.update_multipliers(x, 0.01);
  EXPECT_EQ(stiffness(), 100.0);  // nothing to compare with yet
  for (Index i = 2; i < x.size(); i += 3) x[i] = -0.008;
  contact.update_multipliers(x, 0.01);
  EXPECT_EQ(stiffness(), 100.0);  // has halved
  contact.update_multipliers(x, 0.01);
  EXPECT_EQ(stiffness(), 100.0);  // within the tolerance
  contact.update_multipliers(x, 0.005);
  EXPECT_EQ(stiffness(), 400.0);
  contact.clear_stiffening();
  EXPECT_EQ(stiffness(), 100.0);
  EXPECT_GT(contact.pressure(contact.constraints().front(), x), 2.0);
}
TEST(SurfaceContact, CurvatureMakesFacetsTheSphereTheyComeFrom) {
  // a fine sphere inside a coarse one of the same radius: their facets are up to 0.12 mm apart, the
  // patches not
  const TriMesh coarse = test::icosphere(2, 10.0), fine = test::icosphere(4, 10.0);
  const auto largest_gap = [&](bool curved) {
    SurfaceContact contact(make_particle_surface(test::turned_over(coarse).triangles), fine,
                           {.normal = ContactNormal::smooth});
    const VecX x = test::stacked(coarse);
    if (curved) contact.update_curvature(x);
    contact.update_pairs(x);
    double largest = 0.0;
    for (const ContactSample& sample : contact.samples(x))
      largest = std::max(largest, std::abs(sample.gap));
    return largest;
  };
  EXPECT_GT(largest_gap(false), 0.1);
  EXPECT_LT(largest_gap(true), 0.01);
}
TEST(SurfaceContact, PatternWithAnObstacleDoesNotDependOnThePairs) {
  const TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, 3)),
                floor = test::plate(0.0, 2.0, 3);
  for (const auto rule : {ContactRule::pointwise, ContactRule::nodal}) {
    SurfaceContact contact(make_particle_surface(plate.triangles), floor, {.rule = rule});
    const auto before = contact.pattern();
    const VecX x = test::stacked(plate);
    contact.update_pairs(x);
    EXPECT_EQ(contact.pattern(), before);
    solve::BlockMatrix A(plate.n_vertices(), before);
    A.set_zero();
    contact.add_jacobian(x, VecX(), 1.0, 0.0, A);  // aborts on a block outside the pattern
    EXPECT_GT(A.at(5, 5)(2, 2), 0.0);
  }
}
TEST(SurfaceContact, StiffnessCanBeRaisedLater) {
  const TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, 2)),
                floor = test::plate(0.0, 5.0, 3);
  SurfaceContact contact(make_particle_surface(plate.triangles), floor, {});
  contact.update_stiffness(500.0);
  const VecX x = test::stacked(plate);
  contact.update_pairs(x);
  EXPECT_NEAR(contact.pressure(contact.constraints().front(), x), 10.0, 1e-12);
  EXPECT_THROW(contact.update_stiffness(0.0), Error);
}
TEST(SurfaceContact, RejectsBadOptionsWithTheirValue) {
  const auto make = [](const ContactOptions& options) {
    return SurfaceContact(make_particle_surface(ball.triangles), ball, options);
  };
  EXPECT_THROW(make({.stiffness = 0.0}), Error);
  EXPECT_THROW(make({.minimum_gap = 4.0}), Error);
  EXPECT_THROW(make({.facing = 1.0}), Error);
  EXPECT_THROW(make({.facing_fully = 1.0}), Error);
  EXPECT_THROW(SurfaceContact(make_particle_surface(ball.triangles), TriMesh{}), Error);
  try {
    make({.search_distance = -2.0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("-2"), std::string::npos);
  }
}

TEST(SurfaceContactReach, LeavesOutOnlyWhatCannotPress) {
  const auto make = [] { return ball_contact({ContactNormal::smooth, ContactRule::nodal}); };
  SurfaceContact everywhere = make(), near = make();
  near.update_pairs(ball_x);
  const auto all = near.constraints().size();
  const VecX moved = test::shaken(ball_x, 0.05);
  everywhere.update_pairs(moved);
  near.update_pairs(moved, 0.5);
  EXPECT_LT(near.constraints().size(), all);
  EXPECT_GT(near.constraints().size(), std::size_t{0});
  EXPECT_EQ(force_of(near, moved), force_of(everywhere, moved));
  EXPECT_GT(force_of(near, moved).norm(), 1.0);
}

TEST(SurfaceContactReach, LosesNothingOnALongWayOfShortSteps) {
  const auto make = [] { return ball_contact({ContactNormal::smooth, ContactRule::nodal}); };
  SurfaceContact near = make();
  VecX x = ball_x;
  for (Index i = 2; i < 3 * ball.n_vertices(); i += 3) x[i] -= 2.0;
  int n_pressing = 0;
  for (int step = 0; step < 30; ++step) {
    // up and down, round about, in and out of contact
    const double angle = 0.2 * step;
    for (Index i = 0; i < ball.n_vertices(); ++i) {
      x.segment<3>(3 * i) +=
          Vec3(0.15 * std::cos(angle), 0.15 * std::sin(angle), 0.4 * std::cos(2.3 * angle));
    }
    near.update_pairs(x, 0.3);
    SurfaceContact everywhere = make();
    everywhere.update_pairs(x);
    EXPECT_EQ(force_of(near, x), force_of(everywhere, x)) << "step " << step;
    n_pressing += force_of(near, x).norm() > 1.0 ? 1 : 0;
  }
  EXPECT_GT(n_pressing, 5);
  EXPECT_LT(n_pressing, 30);
}

TEST(SurfaceContactReach, LosesHardlyAnythingWhereSurfacesSlideAlongEachOther) {
  // the ball rolls over the other in steps of half a degree about the other's middle
  const auto make = [] { return ball_contact({ContactNormal::smooth, ContactRule::nodal}); };
  SurfaceContact led = make(), careful = make();
  VecX x = ball_x;
  for (Index i = 2; i < 3 * ball.n_vertices(); i += 3) x[i] -= 1.0;  // a shallow overlap
  led.update_pairs(x);
  careful.update_pairs(x);
  const Vec3 middle(0.3, 0.4, 18.5);
  const Mat3 turn = Eigen::AngleAxisd(0.5 * kPi / 180.0, Vec3::UnitX()).matrix();
  std::size_t n_led = 0, n_careful = 0;
  for (int step = 0; step < 30; ++step) {
    for (Index i = 0; i < ball.n_vertices(); ++i) {
      const Vec3 arm = x.segment<3>(3 * i) - middle;
      x.segment<3>(3 * i) = middle + turn * arm;
    }
    led.update_pairs(x, 0.05, 0.3);
    careful.update_pairs(x, 0.05);
    // inside the other ball a sample may keep to a triangle whose neighbour is a little nearer
    const VecX careful_force = force_of(careful, x);
    EXPECT_LT((force_of(led, x) - careful_force).norm(), 1e-2 * careful_force.norm())
        << "step " << step;
    EXPECT_GT(careful_force.norm(), 1.0);
    n_led += led.constraints().size();
    n_careful += careful.constraints().size();
  }
  EXPECT_LT(n_led, n_careful);
}

TEST(SurfaceContactReach, FindsWhatComesNearInOneStep) {
  SurfaceContact contact = ball_contact({ContactNormal::smooth, ContactRule::nodal});
  VecX far = ball_x;
  for (Index i = 2; i < 3 * ball.n_vertices(); i += 3) far[i] += 50.0;
  contact.update_pairs(far, 0.5);
  EXPECT_EQ(contact.constraints().size(), std::size_t{0});
  contact.update_pairs(ball_x, 0.5);
  SurfaceContact everywhere = ball_contact({ContactNormal::smooth, ContactRule::nodal});
  everywhere.update_pairs(ball_x);
  EXPECT_EQ(force_of(contact, ball_x), force_of(everywhere, ball_x));
}

/// A plate of side 10 over a shifted floor of another mesh; the plate looks down.
struct PlateOverFloor {
  TriMesh plate = test::turned_over(test::plate(-0.02, 5.0, 4)), floor = test::plate(0.0, 5.0, 7);
  VecX x;
  PlateOverFloor() {
    floor.points.rowwise() += Eigen::RowVector3d(2.3, -1.1, 0.0);
    x = test::stacked(plate, floor);
  }
  SurfaceContact contact(ContactQuadrature quadrature) const {
    return SurfaceContact(make_particle_surface(plate.triangles),
                          make_particle_surface(test::after(plate, floor)),
                          {.quadrature = quadrature, .rule = ContactRule::nodal});
  }
};

TEST(CutQuadrature, CoversExactlyWhereTheSurfacesOverlap) {
  const PlateOverFloor shapes;
  SurfaceContact contact = shapes.contact(ContactQuadrature::cut);
  contact.update_pairs(shapes.x);
  double area = 0.0;
  for (const ContactSample& sample : contact.samples(shapes.x)) area += sample.area;
  EXPECT_NEAR(area, (10.0 - 2.3) * (10.0 - 1.1), 1e-9);
}

TEST(CutQuadrature, GivesBothSurfacesTheConsistentForcesOfAUniformPressure) {
  const PlateOverFloor shapes;
  SurfaceContact contact = shapes.contact(ContactQuadrature::cut);
  contact.update_pairs(shapes.x);
  const VecX force = force_of(contact, shapes.x);
  // inside the overlap a floor vertex carries a third of the areas around it
  const Points vertices = shapes.floor.points;
  const VecX areas = triangle_areas(shapes.floor);
  int inside = 0;
  for (Index v = 0; v < vertices.rows(); ++v) {
    double around = 0.0, reach = 0.0;
    for (Index t = 0; t < shapes.floor.n_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (shapes.floor.triangles(t, k) != v) continue;
        around += areas[t] / 3.0;
        for (int other = 0; other < 3; ++other) {
          const Vec3 corner = vertices.row(shapes.floor.triangles(t, other));
          reach = std::max(reach, corner.head<2>().lpNorm<Eigen::Infinity>());
        }
      }
    }
    if (reach > 5.0) continue;
    ++inside;
    EXPECT_NEAR(force[3 * (shapes.plate.n_vertices() + v) + 2], -100.0 * 0.02 * around,
                1e-9 * around);
  }
  EXPECT_GT(inside, 4);
}

TEST(CutQuadrature, ForceIsTheSlopeOfTheEnergyOnBalls) {
  SurfaceContact contact(make_particle_surface(ball.triangles),
                         make_particle_surface(test::after(ball, other_ball)),
                         {.stiffness = 50.0,
                          .normal = ContactNormal::smooth,
                          .quadrature = ContactQuadrature::cut,
                          .rule = ContactRule::nodal});
  contact.update_pairs(ball_x);
  contact.update_multipliers(ball_x);
  const VecX force = force_of(contact, ball_x);
  ASSERT_GT(force.norm(), 1.0);
  for (Index i = 0; i < ball_x.size(); ++i) {
    if (force[i] == 0.0) continue;
    VecX ahead = ball_x, behind = ball_x;
    ahead[i] += 1e-5;
    behind[i] -= 1e-5;
    const double slope = (contact.energy(ahead) - contact.energy(behind)) / 2e-5;
    EXPECT_NEAR(-slope, force[i], 1e-5 * force.lpNorm<Eigen::Infinity>());
  }
}

TEST(CutQuadrature, AgreesWithManyPointsOnBallsAndIsBitIdenticalForOneAndEightThreads) {
  const auto push = [](ContactQuadrature quadrature) {
    SurfaceContact contact(make_particle_surface(ball.triangles),
                           make_particle_surface(test::after(ball, other_ball)),
                           {.stiffness = 50.0,
                            .normal = ContactNormal::smooth,
                            .quadrature = quadrature,
                            .rule = ContactRule::nodal});
    contact.update_pairs(ball_x);
    return force_of(contact, ball_x);
  };
  const auto run = [&] { return push(ContactQuadrature::cut); };
  const VecX one = with_threads(1, run), six = push(ContactQuadrature::six_points);
  EXPECT_EQ(one, with_threads(8, run));
  EXPECT_LE((one - six).norm(), 0.05 * six.norm());
}

TEST(CutQuadrature, NeedsTheNodalRule) {
  try {
    SurfaceContact(make_particle_surface(ball.triangles), other_ball,
                   {.quadrature = ContactQuadrature::cut});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nodal rule"), std::string::npos);
  }
}

}  // namespace coxa::collide
