#include "meshing/octree.h"

#include <gtest/gtest.h>
#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace coxa::meshing {
namespace {

std::vector<OctreeCell> leaves_of(const Octree& octree) {
  std::vector<OctreeCell> leaves;
  for (const OctreeCell& cell : octree.cells())
    if (cell.children == 0) leaves.push_back(cell);
  return leaves;
}

TEST(Octree, HasLeavesThatFillTheRootOnce) {
  const Octree octree(coxa::test::torus(), {.flatness = 0.2, .smallest = 0.5, .largest = 4.0});
  double volume = 0.0;
  for (const OctreeCell& leaf : leaves_of(octree)) {
    volume += std::pow(leaf.size, 3);
    const OctreeCell* found = octree.leaf_at(leaf.centre());
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->low, leaf.low);
  }
  EXPECT_EQ(volume, std::pow(octree.cells()[0].size, 3));
  EXPECT_EQ(octree.leaf_at({-1, 0, 0}), nullptr);
}

// how many of the three intervals of two cubes overlap by more than a point; 3 axes touch at least
int shared_axes(const OctreeCell& a, const OctreeCell& b) {
  int overlapping = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int gap = std::max(a.low[k], b.low[k]) - std::min(a.low[k] + a.size, b.low[k] + b.size);
    if (gap > 0) return 0;
    overlapping += gap < 0;
  }
  return overlapping;
}

TEST(Octree, HasNeighboursThatDifferByTwoAtMost) {
  const Octree octree(coxa::test::box(Vec3(-9, -7, -1), Vec3(9, 7, 1)),
                      {.flatness = 0.1, .smallest = 0.2, .largest = 10.0});
  const std::vector<OctreeCell> leaves = leaves_of(octree);
  int largest = 0;
  for (const OctreeCell& a : leaves) {
    largest = std::max(largest, a.size);
    for (const OctreeCell& b : leaves) ASSERT_TRUE(shared_axes(a, b) == 0 || a.size <= 2 * b.size);
  }
  EXPECT_GE(largest, 8);
}

TEST(Octree, IsFineWhereTheSurfaceBendsAndNoFinerThanAsked) {
  const TriMesh bar = coxa::test::box(Vec3(-20, -5, -5), Vec3(20, 5, 5));
  const Octree fine(bar, {.flatness = 0.05, .smallest = 0.3, .largest = 2.0});
  const Octree coarse(bar, {.flatness = 0.5, .smallest = 0.3, .largest = 2.0});
  const auto size_near = [](const Octree& octree, const Vec3& p) {
    double nearest = kInfinity;
    int size = 0;
    for (const OctreeCell& leaf : leaves_of(octree)) {
      const double distance = (octree.position(leaf.centre()) - p).norm();
      if (distance < nearest) {
        nearest = distance;
        size = leaf.size;
      }
    }
    return size * (octree.position({1, 0, 0}) - octree.position({0, 0, 0}))[0];
  };
  EXPECT_GE(size_near(fine, Vec3(0, 0, 5)), 1.0);
  EXPECT_LE(size_near(fine, Vec3(0, 5, 5)), 0.6);
  EXPECT_GE(size_near(fine, Vec3(0, 5, 5)), 0.3 - 1e-9);
  EXPECT_GT(size_near(coarse, Vec3(0, 5, 5)), size_near(fine, Vec3(0, 5, 5)));
  EXPECT_LE(size_near(coarse, Vec3(0, 0, 5)), 2.0);
}

TEST(Octree, IsFineAtThePlacesNamed) {
  const Vec3 place(3.0, 1.0, 5.0);
  OctreeOptions options{.flatness = 0.5, .smallest = 1.0, .largest = 4.0};
  const TriMesh bar = coxa::test::box(Vec3(-20, -5, -5), Vec3(20, 5, 5));
  const double before = Octree(bar, options).size_at(place);
  EXPECT_GE(before, 2.0);
  options.fine_places.push_back({place, 0.25});
  const Octree octree(bar, options);
  EXPECT_EQ(octree.size_at(place), 0.25);
  EXPECT_EQ(octree.size_at(Vec3(-15.0, 1.0, 5.0)), before);
  // elsewhere no cube is finer than asked for, but next to the place
  for (const OctreeCell& leaf : leaves_of(octree))
    if (octree.size_at(octree.position(leaf.centre())) < 0.99) {
      EXPECT_LT((octree.position(leaf.centre()) - place).norm(), 4.0);
    }
}

}  // namespace
}  // namespace coxa::meshing
