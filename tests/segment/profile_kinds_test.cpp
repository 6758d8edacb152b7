#include <coxa/segment/profile_kinds.h>

#include <coxa/segment/profile_search.h>

#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

SimplexMesh egg() { return make_simplex_mesh(toy::egg_surface({}, 3)); }

/// Another kind of profile on the lower half.
shape::ProfileSet two_halves(const SimplexMesh& mesh) {
  shape::ProfileSet set = toy::profiles("t1", mesh.n_vertices(), toy::t1_value);
  const shape::ProfileSet other = toy::profiles("bright", mesh.n_vertices(), toy::bright_value);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.points(v, 2) < 0.0) set.mean.row(v) = other.mean.row(v);
  }
  return set;
}

TEST(ProfileKinds, FindsTheKindsAndWhereTheyAre) {
  const SimplexMesh mesh = egg();
  const shape::ProfileSet set = two_halves(mesh);
  const ProfileKinds kinds = profile_kinds(set, mesh.neighbours);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_NEAR(kinds.share.row(v).sum(), 1.0, 1e-9);
    if (std::abs(mesh.points(v, 2)) < 20.0) continue;  // mixed about the equator
    Index most = 0;
    kinds.share.row(v).maxCoeff(&most);
    EXPECT_LT((kinds.mean.row(most) - set.mean.row(v)).norm(), 1e-6) << v;
  }
}

TEST(ProfileKinds, AVertexMayTakeItsNeighboursKind) {
  // the image has the upper kind everywhere; means of the lower half alone would not fit it
  const SimplexMesh mesh = egg();
  shape::ProfileSet set = two_halves(mesh);
  const ProfileKinds kinds{set.mean.row(0).replicate(1, 1), MatX::Ones(mesh.n_vertices(), 1)};
  const Volume volume = toy::image_of(toy::egg_surface({}, 3), {});
  const PreparedImage image = prepare_image(volume, false);
  const Points normals = simplex_normals(mesh);
  const ProfileSearch search{.range = 1.0, .window = 2.0};
  const ProfileScores own = score_profiles(image, mesh.points, normals, set, search);
  ASSERT_GT(own.score.rows(), 0);
  const ProfileScores any = score_profiles(image, mesh.points, normals, set, search, &kinds);
  const Index upper = mesh.points(0, 2) >= 0.0 ? 1 : 0;
  ASSERT_EQ(upper, 1) << "vertex 0 is expected in the upper half";
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.points(v, 2) > -5.0) continue;
    EXPECT_GT(any.correlation(v, any.n_each_way), own.correlation(v, own.n_each_way)) << v;
    EXPECT_GT(any.correlation(v, any.n_each_way), 0.8) << v;
  }
}

}  // namespace
}  // namespace coxa::segment
