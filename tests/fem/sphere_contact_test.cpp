#include <coxa/core/error.h>
#include <coxa/fem/sphere_contact.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/witness.h"
#include "fem/shapes.h"

namespace coxa::fem {

// a triangle in the plane z = 0 with nodes in the middle of its sides, and a sphere that dips into
// it
VecX flat_triangle() {
  return (VecX(18) << 0, 0, 0, 2, 0, 0, 0, 3, 0, 1, 0, 0, 1, 1.5, 0, 0, 1.5, 0).finished();
}
ContactFaces face(int nodes) {
  ContactFaces faces(1, nodes);
  for (int a = 0; a < nodes; ++a) faces(0, a) = a;
  return faces;
}
const RigidSphere kSphere{Vec3(0.7, 0.8, 9.9), 10.0};

TEST(SphereContact, HasTheForceOfItsEnergyAndItsJacobian) {
  Rng rng(4);
  for (const int nodes : {3, 6}) {
    const SphereContact contact(face(nodes), flat_triangle(), kSphere, 40.0);
    VecX x = flat_triangle();
    for (double& value : x) value += 0.01 * rng.normal();
    const VecX f = dynamics::test::force_at(contact, x, x);
    EXPECT_GT(f.norm(), 0.1);
    EXPECT_LE((f - dynamics::test::numeric_force(contact, x)).norm(), 1e-7);
    EXPECT_LE((dynamics::test::given_stiffness(contact, x, x) -
               dynamics::test::numeric_stiffness(contact, x, x))
                  .norm(),
              1e-5);
  }
}
TEST(SphereContact, PressesByPenetrationTimesArea) {
  // nearly a plane at depth 0.01 mm: force = k depth area, straight down
  const RigidSphere plane{Vec3(0.6, 0.9, 1e6 - 0.01), 1e6};
  for (const int nodes : {3, 6}) {
    const SphereContact contact(face(nodes), flat_triangle(), plane, 50.0);
    EXPECT_LE((contact.resultant(flat_triangle()) - Vec3(0, 0, -50.0 * 0.01 * 3.0)).norm(), 1e-4);
    EXPECT_NEAR(contact.pressure_at(Vec3(0.6, 0.9, 0)), 0.5, 1e-8);
  }
}
TEST(SphereContact, DoesNothingWhereItIsOpen) {
  SphereContact contact(face(3), flat_triangle(), kSphere, 40.0);
  contact.set_sphere({Vec3(0, 0, 12), 10.0});
  EXPECT_EQ(contact.energy(flat_triangle()), 0.0);
  EXPECT_EQ(contact.resultant(flat_triangle()), Vec3(0, 0, 0));
  EXPECT_EQ(contact.pressure_at(Vec3::Zero()), 0.0);
}
TEST(SphereContact, RejectsBadFacesAndValues) {
  EXPECT_THROW(SphereContact(ContactFaces(1, 4), flat_triangle(), kSphere, 1.0), Error);
  EXPECT_THROW(SphereContact(face(3), flat_triangle(), kSphere, 0.0), Error);
  EXPECT_THROW(SphereContact(face(3), flat_triangle(), {Vec3::Zero(), 0.0}, 1.0), Error);
}

}  // namespace coxa::fem
