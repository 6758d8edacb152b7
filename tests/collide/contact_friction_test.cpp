#include <coxa/collide/contact_friction.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <cmath>

#include "collide/shapes.h"

namespace coxa::collide {
namespace {

constexpr double kDepth = 0.02, kStiffness = 100.0, kCoefficient = 0.3;
constexpr double kNormalForce = kStiffness * kDepth * 100.0;  // N, on 10 mm × 10 mm

/// A plate of side 10 sunk 0.02 mm into a floor of particles.
struct Plate {
  TriMesh plate = test::turned_over(test::plate(-kDepth, 5.0, 4)), floor = test::plate(0.0, 7.0, 5);
  VecX x = test::stacked(plate, floor);
  SurfaceContact contact{make_particle_surface(plate.triangles),
                         make_particle_surface(test::after(plate, floor)),
                         {.stiffness = kStiffness, .rule = ContactRule::nodal}};
  ContactFriction friction{kCoefficient, 1000.0};

  Plate() {
    contact.update_pairs(x);
    friction.begin_step(x);
    friction.update(contact, x);
  }
  VecX moved(const Vec3& by) const {
    VecX there = x;
    for (Index i = 0; i < plate.n_vertices(); ++i) there.segment<3>(3 * i) += by;
    return there;
  }
};

TEST(ContactFriction, GrowsWithTheSlipUpToTheCoefficientTimesTheNormalForce) {
  const Plate s;
  EXPECT_LT(s.friction.resultant(s.x).norm(), 1e-12);
  const Vec3 little = s.friction.resultant(s.moved(Vec3(1e-4, 0, 0)));
  EXPECT_NEAR(little.x(), -1000.0 * 1e-4 * 100.0, 1e-6);
  EXPECT_NEAR(little.y(), 0.0, 1e-9);
  const Vec3 far = s.friction.resultant(s.moved(Vec3(0.3, 0.4, 0)));
  EXPECT_NEAR(far.x(), -0.6 * kCoefficient * kNormalForce, 1e-6);
  EXPECT_NEAR(far.y(), -0.8 * kCoefficient * kNormalForce, 1e-6);
  EXPECT_NEAR(far.z(), 0.0, 1e-9);
}

TEST(ContactFriction, ActsOnBothSurfacesAlike) {
  const Plate s;
  const VecX there = s.moved(Vec3(0.01, -0.02, 0));
  VecX force = VecX::Zero(there.size());
  s.friction.add_force(there, there, force);
  Vec3 sum = Vec3::Zero();
  for (Index i = 0; i < force.size() / 3; ++i) sum += force.segment<3>(3 * i);
  EXPECT_GT(force.norm(), 1.0);
  EXPECT_LT(sum.norm(), 1e-10 * force.norm());
}

TEST(ContactFriction, ForceIsTheSlopeOfTheEnergyAndJacobianOfTheForce) {
  const Plate s;
  const auto force_at = [&](const VecX& x) {
    VecX force = VecX::Zero(x.size());
    s.friction.add_force(x, x, force);
    return force;
  };
  for (const Vec3& by : {Vec3(1e-4, 2e-4, 0), Vec3(0.02, 0.01, 0)}) {  // sticking, sliding
    const VecX x = test::shaken(s.moved(by), 1e-5);
    const VecX force = force_at(x), direction = test::shaken(VecX::Zero(x.size()), 1.0);
    const double h = 1e-7;
    const double slope =
        (s.friction.energy(x + h * direction) - s.friction.energy(x - h * direction)) / (2.0 * h);
    EXPECT_NEAR(-slope, force.dot(direction), 1e-5 * force.norm() * direction.norm());
    solve::BlockMatrix A(static_cast<Index>(x.size() / 3), s.friction.pattern());
    A.set_zero();
    s.friction.add_jacobian(x, x, 1.0, 0.0, A);
    VecX product;
    A.multiply(direction, product);
    const VecX difference = (force_at(x + h * direction) - force_at(x - h * direction)) / (2.0 * h);
    EXPECT_LE((product + difference).norm(), 1e-4 * product.norm());
    VecX by_terms = VecX::Zero(x.size());
    s.friction.for_each_term(
        x, [&](double stiffness, const Index* particle, const Vec3* vectors, Index n) {
          double slip = 0.0;
          for (Index k = 0; k < n; ++k)
            slip += vectors[k].dot(direction.segment<3>(3 * Eigen::Index{particle[k]}));
          for (Index k = 0; k < n; ++k)
            by_terms.segment<3>(3 * Eigen::Index{particle[k]}) += stiffness * slip * vectors[k];
        });
    EXPECT_LE((by_terms - product).norm(), 1e-10 * product.norm());
  }
}

TEST(ContactFriction, KeepsItsTractionFromStepToStep) {
  Plate s;
  const VecX first = s.moved(Vec3(1e-4, 0, 0));
  s.friction.end_step(first);
  s.friction.begin_step(first);
  s.friction.update(s.contact, first);
  EXPECT_NEAR(s.friction.resultant(first).x(), -1000.0 * 1e-4 * 100.0, 1e-6);
  EXPECT_NEAR(s.friction.resultant(s.moved(Vec3(2e-4, 0, 0))).x(), -2000.0 * 1e-4 * 100.0, 1e-6);
}

TEST(ContactFriction, RejectsWhatHasNoMeaning) {
  EXPECT_THROW(ContactFriction(-0.1, 1.0), Error);
  EXPECT_THROW(ContactFriction(0.1, 0.0), Error);
}

}  // namespace
}  // namespace coxa::collide
