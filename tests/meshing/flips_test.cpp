#include "meshing/flips.h"

#include "meshing/grid_topology.h"
#include "meshing/solid_guide.h"

#include <coxa/core/rng.h>
#include <gtest/gtest.h>
#include "grids.h"
#include "support/shapes.h"

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

// n elements around an upright edge of the given half length in a ring of radius 1
TetGrid spindle(int n, double half_length) {
  std::vector<Vec3> x{{0, 0, -half_length}, {0, 0, half_length}};
  std::vector<Tet> tets;
  for (int k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * k / n;
    x.emplace_back(std::cos(a), std::sin(a), 0.0);
    tets.push_back({0, 1, 2 + k, 2 + (k + 1) % n});
  }
  return test::make_grid(x, tets);
}

struct Anywhere : SlideGuide {
  Vec3 place(NodeKind, const Vec3& p) const override { return p; }
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind,
                                                               const Vec3&) const override {
    return Mat3::Identity();
  }
};

double worst(const TetGrid& grid) {
  double least = kInfinity;
  for (const Tet& t : grid.tets)
    if (t[0] >= 0) least = std::min(least, flip_quality(grid, t));
  return least;
}

TEST(Flips, FindTheRingOfAnEdgeInOrder) {
  const TetGrid grid = spindle(5, 1.0);
  const EdgeRing ring = ring_around(grid, 0, 1);
  ASSERT_TRUE(ring.closed);
  ASSERT_EQ(ring.corners.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ((ring.corners[(k + 1) % 5] - ring.corners[k] + 5) % 5, 1);
  const EdgeRing spoke = ring_around(grid, 0, 2);
  EXPECT_FALSE(spoke.closed);
  EXPECT_EQ(spoke.corners.size(), 3U);
}

TEST(Flips, RemoveALongEdgeAmongThreeToSixElements) {
  for (const int n : {3, 4, 5, 6}) {
    TetGrid grid = spindle(n, 4.0);
    const double before = worst(grid), volume = test::volume_of(grid);
    EXPECT_GT(flip_poor(grid, Anywhere{}, {.below = 0.9, .collapse = false}), 0);
    EXPECT_FALSE(has_edge(grid, 0, 1)) << n;
    EXPECT_GT(worst(grid), before);
    EXPECT_NEAR(test::volume_of(grid), volume, 1e-12);
    EXPECT_EQ(
        std::count_if(grid.tets.begin(), grid.tets.end(), [](const Tet& t) { return t[0] >= 0; }),
        2 * (n - 2));
  }
}

TEST(Flips, ReplaceAFaceBetweenFlatElementsByAnEdge) {
  TetGrid grid = spindle(3, 0.2);
  const double volume = test::volume_of(grid);
  TetGrid two = test::make_grid(grid.x, {{2, 3, 4, 1}, {2, 4, 3, 0}});
  EXPECT_EQ(flip_poor(two, Anywhere{}, {.below = 0.9, .collapse = false}), 1);
  EXPECT_TRUE(has_edge(two, 0, 1));
  EXPECT_NEAR(test::volume_of(two), volume, 1e-12);
}

TEST(Flips, MakeNoMoreElementsThanAllowed) {
  TetGrid grid = spindle(6, 4.0);
  flip_poor(grid, Anywhere{}, {.below = 0.9, .max_tets = 7, .collapse = false});
  EXPECT_TRUE(has_edge(grid, 0, 1));
  flip_poor(grid, Anywhere{}, {.below = 0.9, .max_tets = 8, .collapse = false});
  EXPECT_FALSE(has_edge(grid, 0, 1));
}

TEST(Flips, LeaveGoodElementsAlone) {
  TetGrid grid = spindle(5, 0.8);
  EXPECT_EQ(flip_poor(grid, Anywhere{}, {.below = 0.3}), 0);
}

TEST(Flips, RaiseTheWorstElementOfARandomMeshAndKeepItValid) {
  const TriMesh ball = coxa::test::icosphere(2, 10.0);
  const TriangleTree tree(ball.points, ball.triangles);
  const SolidGuide guide(tree);
  Rng rng(3);
  std::vector<Vec3> x{Vec3::Zero()};
  std::vector<Tet> tets;
  for (Index v = 0; v < ball.n_vertices(); ++v) x.push_back(ball.points.row(v));
  for (Index t = 0; t < ball.n_triangles(); ++t) {
    // cone over each triangle, split at a random point inside
    const Index a = ball.triangles(t, 0) + 1, b = ball.triangles(t, 1) + 1,
                c = ball.triangles(t, 2) + 1, m = static_cast<Index>(x.size());
    const auto at = [&](Index v) { return x[static_cast<std::size_t>(v)]; };
    x.push_back(rng.uniform(0.4, 0.9) * (0.4 * at(a) + 0.3 * at(b) + 0.3 * at(c)));
    tets.insert(tets.end(), {{0, a, b, m}, {0, b, c, m}, {0, c, a, m}, {a, b, c, m}});
  }
  for (Tet& t : tets) {
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    if (volume6(at(0), at(1), at(2), at(3)) < 0.0) std::swap(t[2], t[3]);
  }
  TetGrid grid = test::make_grid(x, tets);
  grid.kinds[0] = NodeKind::inside;
  for (std::size_t v = static_cast<std::size_t>(ball.n_vertices()) + 1; v < x.size(); ++v)
    grid.kinds[v] = NodeKind::inside;
  const double before = worst(grid), volume = test::volume_of(grid);
  EXPECT_GT(flip_poor(grid, guide, {.below = 0.6, .tolerance = 0.5}), 100);
  EXPECT_GT(worst(grid), before);
  EXPECT_GT(test::least_volume(grid), 0.0);
  EXPECT_EQ(test::boundary_fault(grid), "");
  EXPECT_NEAR(test::volume_of(grid) / volume, 1.0, 0.02);
}

TEST(Flips, KeepTheBoundaryWhereItWouldLeaveTheSurface) {
  // a ridge along the edge 0-1: swapping it would cut the ridge off
  const TriMesh roof = [] {
    TriMesh mesh;
    mesh.points.resize(4, 3);
    mesh.points << -4, 0, 0, 4, 0, 0, 0, 1, -1, 0, -1, -1;
    mesh.triangles.resize(4, 3);
    mesh.triangles << 0, 1, 2, 1, 0, 3, 0, 2, 3, 1, 3, 2;
    return mesh;
  }();
  const TriangleTree tree(roof.points, roof.triangles);
  const std::vector<Vec3> x{{-4, 0, 0}, {4, 0, 0}, {0, 1, -1}, {0, -1, -1}, {0, 0, -1}};
  TetGrid grid = test::make_grid(x, {{0, 1, 2, 4}, {1, 0, 3, 4}});
  for (Tet& t : grid.tets)
    if (flip_quality(grid, t) == 0.0) std::swap(t[0], t[1]);
  grid.link();
  flip_poor(grid, SolidGuide(tree), {.below = 0.9, .tolerance = 0.1});
  EXPECT_TRUE(has_edge(grid, 0, 1));
}

}  // namespace
}  // namespace coxa::meshing
