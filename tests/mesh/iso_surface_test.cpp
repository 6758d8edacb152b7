#include <coxa/mesh/iso_surface.h>

#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <vector>

namespace coxa {

const auto as_is = [](const Vec3& index) { return index; };

template <class F>
std::vector<float> sampled(const std::array<Index, 3>& size, const F& f) {
  std::vector<float> values;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) values.push_back(static_cast<float>(f(Vec3(i, j, k))));
  return values;
}
double ball(const Vec3& p) { return 8.0 - (p - Vec3(10, 11, 12)).norm(); }

TEST(IsoSurface, OfABallLiesOnTheSphere) {
  const TriMesh mesh = iso_surface({21, 23, 25}, sampled({21, 23, 25}, ball), 0.0, as_is);
  EXPECT_EQ(genus(mesh), 0);
  const VecX r = (mesh.points.rowwise() - Vec3(10, 11, 12).transpose()).rowwise().norm();
  EXPECT_LE((r.array() - 8.0).abs().maxCoeff(), 0.05);
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * kPi * 512, 0.01 * 4.0 / 3.0 * kPi * 512);
}
TEST(IsoSurface, OfALinearFieldIsExact) {
  const auto mesh = iso_surface(
      {9, 9, 9}, sampled({9, 9, 9}, [](const Vec3& p) { return 4.3 - p[0]; }), 0.0, as_is);
  int on_plane = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if ((mesh.points.row(v).tail<2>().array() >= 0.0).all() &&
        (mesh.points.row(v).tail<2>().array() <= 8.0).all() && mesh.points(v, 0) > 0) {
      EXPECT_NEAR(mesh.points(v, 0), 4.3, 1e-6);
      ++on_plane;
    }
  EXPECT_GE(on_plane, 81);
}
TEST(IsoSurface, IsClosedManifoldForRandomValues) {
  // noise meets every case of every tetrahedron, at the border too
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Rng rng(seed);
    const auto values = sampled({7, 6, 5}, [&](const Vec3&) { return rng.below(3) - 1.0; });
    const TriMesh mesh = iso_surface({7, 6, 5}, values, 0.0, as_is);
    ASSERT_EQ(manifold_fault(mesh), "");
    ASSERT_GT(volume(mesh), 0.0);
    ASSERT_GT(triangle_areas(mesh).minCoeff(), 0.0);
  }
}
TEST(IsoSurface, OfOneSampleIsAClosedCell) {
  const std::vector<float> one{1.0f, 0.0f};
  const TriMesh mesh = iso_surface({2, 1, 1}, one, 0.5, as_is);
  EXPECT_EQ(genus(mesh), 0);
  EXPECT_LE(mesh.points.cwiseAbs().maxCoeff(), 0.5);
}
TEST(IsoSurface, IsOutwardUnderMirroredAndObliqueMaps) {
  const auto values = sampled({21, 23, 25}, ball);
  const RigidTransform X = test::some_pose();
  const double v = volume(iso_surface({21, 23, 25}, values, 0.0, as_is));
  const auto mirror = [&](const Vec3& i) {
    return Vec3(X * Vec3(-0.5 * i[0], 0.7 * i[1], 2.0 * i[2]));
  };
  EXPECT_NEAR(volume(iso_surface({21, 23, 25}, values, 0.0, mirror)), 0.7 * v, 1e-6 * v);
}
TEST(IsoSurface, RejectsEmptyAndBrokenInput) {
  const std::vector<float> zeros(8, 0.0f);
  EXPECT_THROW(iso_surface({2, 2, 2}, zeros, 0.5, as_is), Error);
  EXPECT_THROW(iso_surface({2, 2, 2}, zeros, -0.5, as_is), Error);
  EXPECT_THROW(iso_surface({3, 2, 2}, zeros, 0.0, as_is), Error);
  std::vector<float> broken(8, 1.0f);
  broken[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(iso_surface({2, 2, 2}, broken, 0.5, as_is), Error);
}

}  // namespace coxa
