#include <coxa/mesh/voxelize.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <numeric>

namespace coxa {

TEST(InsideSamples, AgreeWithTheSignedDistance) {
  const std::array<Index, 3> size{30, 31, 32};
  for (const TriMesh& mesh :
       {test::torus(), test::lunate_shell(10.0, 2.0), test::icosphere(3, 12.0)}) {
    for (double mirror : {1.0, -1.0}) {
      const RigidTransform X{test::some_pose().R, Vec3::Zero()};
      const auto index = [&](const Vec3& p) {
        return Vec3(Vec3(mirror, 1, 1).cwiseProduct(X * p) + Vec3(15, 15.5, 16));
      };
      const auto inside = inside_samples(mesh, size, index);
      const TriangleTree tree(mesh.points, mesh.triangles);
      for (Index k = 0; k < 32; ++k)
        for (Index j = 0; j < 31; ++j)
          for (Index i = 0; i < 30; ++i) {
            const Vec3 p =
                X.inverse() * Vec3(mirror, 1, 1).cwiseProduct(Vec3(i, j, k) - Vec3(15, 15.5, 16));
            ASSERT_EQ(inside[static_cast<std::size_t>(i + 30 * (j + 31 * k))] == 1,
                      tree.signed_distance(p) < 0.0);
          }
    }
  }
}
TEST(InsideSamples, CountABoxOnItsGridExactlyThroughEdgesAndVertices) {
  // rows run exactly through edges and diagonals of the box's triangles
  const auto inside = inside_samples(test::box(Vec3(0.5, 0, 0), Vec3(6.5, 4, 4)), {8, 8, 8},
                                     [](const Vec3& p) { return Vec3(p + Vec3(0, 2, 2)); });
  EXPECT_EQ(std::accumulate(inside.begin(), inside.end(), 0), 6 * 4 * 4);
}
TEST(InsideSamples, OverlappingBodiesCountOnceAndCutOnesAreFilledToTheBorder) {
  TriMesh two = test::box(Vec3(-5, 0.5, 0.5), Vec3(3.5, 3.5, 3.5));
  const TriMesh other = test::box(Vec3(2.5, 0.5, 0.5), Vec3(20, 3.5, 3.5));
  two.points.conservativeResize(16, 3);
  two.points.bottomRows(8) = other.points;
  two.triangles.conservativeResize(24, 3);
  two.triangles.bottomRows(12) = other.triangles.array() + 8;
  const auto inside = inside_samples(two, {8, 8, 8}, [](const Vec3& p) { return p; });
  EXPECT_EQ(std::accumulate(inside.begin(), inside.end(), 0), 8 * 3 * 3);
}
TEST(InsideSamples, AreTheSameForOneAndEightThreads) {
  const auto run = [] {
    return inside_samples(test::torus(), {20, 20, 20},
                          [](const Vec3& p) { return Vec3(p + Vec3(10, 10, 10)); });
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
  EXPECT_THROW(inside_samples(test::box(), {0, 2, 2}, [](const Vec3& p) { return p; }), Error);
}

}  // namespace coxa
