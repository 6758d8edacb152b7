#include <coxa/collide/rigid_pair.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <gtest/gtest.h>

#include "collide/shapes.h"

namespace coxa::collide {

const TriMesh big = test::icosphere(3, 10.0, Vec3::Zero()),
              small = test::icosphere(3, 2.0, Vec3::Zero());
// icosphere facets of level 3 lie at most this share inside the sphere
constexpr double kFacetShare = 0.012;

RigidTransform along_x(double distance) { return {Mat3::Identity(), Vec3(distance, 0, 0)}; }

TEST(RigidPair, ClearanceOfSpheresIsTheirDistance) {
  const RigidPair pair(big, small);
  for (const double gap : {1.5, 0.3, -0.4, -1.2}) {
    const Clearance clearance = pair.clearance(along_x(12.0 + gap), 3.0);
    EXPECT_NEAR(clearance.distance, gap, 10.0 * kFacetShare);
    EXPECT_NEAR(clearance.fixed_point.x(), 10.0, 0.5);
  }
}
TEST(RigidPair, FindsNothingBeyondTheLimit) {
  EXPECT_EQ(RigidPair(big, small).clearance(along_x(14.0), 1.0).distance, kInfinity);
}
TEST(RigidPair, IgnoresVerticesThatDoNotCount) {
  std::vector<bool> counted(static_cast<std::size_t>(small.n_vertices()));
  for (Index v = 0; v < small.n_vertices(); ++v) {
    counted[static_cast<std::size_t>(v)] = small.points(v, 0) > 0.0;
  }
  const RigidPair pair(big, small, counted);
  EXPECT_GT(pair.clearance(along_x(11.5), 3.0).distance, 1.0);
  EXPECT_NEAR(pair.clearance(along_x(-11.5), 3.0).distance, -0.5, 10.0 * kFacetShare);
}
TEST(RigidPair, IsBitIdenticalForOneAndEightThreads) {
  const RigidPair pair(big, small);
  const auto run = [&] { return pair.clearance(along_x(11.9), 3.0).distance; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(RigidPair, RejectsAMaskOfTheWrongLengthAndANegativeLimit) {
  EXPECT_THROW(RigidPair(big, small, std::vector<bool>(3, true)), Error);
  EXPECT_THROW(RigidPair(big, small).clearance({}, 0.0), Error);
}
TEST(Penetration, IsTheDepthOfOverlapAndZeroApart) {
  TriMesh moved = small;
  moved.points.col(0).array() += 11.0;
  EXPECT_NEAR(penetration(big, moved), 1.0, 10.0 * kFacetShare);
  moved.points.col(0).array() += 2.0;
  EXPECT_EQ(penetration(big, moved), 0.0);
}
TEST(FirstContact, OfAnApproachingSphereIsWhereTheRadiiMeet) {
  const RigidPair pair(big, small);
  const auto pose = [](double s) { return along_x(20.0 - s); };
  const auto contact = first_contact(pair, pose, 15);
  ASSERT_TRUE(contact.has_value());
  EXPECT_NEAR(contact->parameter, 8.0, 10.0 * kFacetShare);
  EXPECT_NEAR(contact->clearance.distance, 0.0, 2e-3);
  const auto earlier = first_contact(pair, pose, 15, 0.5);
  EXPECT_NEAR(earlier->parameter, 7.5, 10.0 * kFacetShare);
}
TEST(FirstContact, IsAbsentWhereTheSurfacesStayApartAndAtZeroWhereTheyStartTogether) {
  const RigidPair pair(big, small);
  EXPECT_FALSE(first_contact(
                   pair, [](double s) { return along_x(20.0 - 0.1 * s); }, 15)
                   .has_value());
  EXPECT_EQ(first_contact(
                pair, [](double) { return along_x(11.0); }, 3)
                ->parameter,
            0.0);
}

}  // namespace coxa::collide
