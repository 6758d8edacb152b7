#include "meshing/misses.h"

#include "meshing/surface_places.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coxa::meshing {
namespace {

TEST(Misses, PlacesWithinAreOfLargeTrianglesOnly) {
  const TriMesh box = coxa::test::box();  // edges of 2 mm
  EXPECT_TRUE(places_within(box, 4.0).empty());
  const std::vector<Vec3> places = places_within(box, 0.5);
  // the diagonals of 2.83 mm in six parts: 5 + 4 + … within each of twelve triangles less the
  // border
  EXPECT_EQ(places.size(), 12u * 10u);
  for (const Vec3& p : places) EXPECT_NEAR(p.cwiseAbs().maxCoeff(), 1.0, 1e-12);
}

TEST(Misses, AreToldInBothDirections) {
  const TriMesh box = coxa::test::box();
  EXPECT_NEAR(envelope_error(box, box), 0.0, 1e-12);
  TriMesh smaller = box;
  smaller.points *= 0.9;
  EXPECT_NEAR(envelope_error(smaller, box), 0.1 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(envelope_error(box, smaller), 0.1 * std::sqrt(2.0), 1e-12);
}

}  // namespace
}  // namespace coxa::meshing
