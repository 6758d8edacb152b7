#include <coxa/segment/follow_mask.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/validate.h>
#include <coxa/mesh/voxelize.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/shapes.h"

namespace coxa::segment {

class FollowMask : public ::testing::Test {
 protected:
  FollowMask() {
    grid_.size = {50, 50, 50};
    grid_.spacing = Vec3(1.0, 1.0, 1.0);
    grid_.origin = Vec3(-25.0, -25.0, -25.0);
  }
  std::vector<std::uint8_t> mask_where(const std::function<bool(const Vec3&)>& inside) const {
    std::vector<std::uint8_t> mask;
    for (Index k = 0; k < grid_.size[2]; ++k)
      for (Index j = 0; j < grid_.size[1]; ++j)
        for (Index i = 0; i < grid_.size[0]; ++i)
          mask.push_back(inside(grid_.position(Vec3(i, j, k))) ? 1 : 0);
    return mask;
  }
  std::vector<std::uint8_t> own() const {
    return inside_samples(ball_, grid_.size, [&](const Vec3& p) { return grid_.index(p); });
  }
  Volume grid_;
  TriMesh ball_ = test::icosphere(4, 15.0);
};

TEST_F(FollowMask, LeavesASurfaceWhoseVoxelsItIs) {
  const Points before = ball_.points;
  EXPECT_DOUBLE_EQ(update_to_mask(ball_, own(), grid_), 1.0);
  EXPECT_EQ(ball_.points, before);
}
TEST_F(FollowMask, GoesToABumpSmoothlyAndLeavesTheFarSide) {
  const auto bump = [](const Vec3& p) {
    return p.norm() < 15.0 || (p - Vec3(0.0, 0.0, 12.0)).norm() < 8.0;
  };
  const Points before = ball_.points;
  EXPECT_GT(update_to_mask(ball_, mask_where(bump), grid_), 0.985);
  EXPECT_TRUE(validate(ball_).valid()) << validate(ball_).text();
  double off = 0.0, far = 0.0;
  for (Index v = 0; v < ball_.n_vertices(); ++v) {
    const Vec3 p = ball_.points.row(v), q = before.row(v);
    if (q.z() < 0.0) far = std::max(far, (p - q).norm());
    // on the bump's dome, away from its crease: as smooth as the ball that was drawn, not as its
    // voxels
    if (p.z() > 17.0) off = std::max(off, std::abs((p - Vec3(0.0, 0.0, 12.0)).norm() - 8.0));
  }
  EXPECT_LT(far, 0.2);
  EXPECT_LT(off, 0.6);
}
TEST_F(FollowMask, GivesUpWhatWasErased) {
  const auto flat = [](const Vec3& p) { return p.norm() < 15.0 && p.z() < 9.0; };
  EXPECT_GT(update_to_mask(ball_, mask_where(flat), grid_), 0.985);
  EXPECT_LT(ball_.points.col(2).maxCoeff(), 10.0);
}
TEST_F(FollowMask, IsTheSameForOneAndEightThreads) {
  const auto bump =
      mask_where([](const Vec3& p) { return (p - Vec3(1.0, 2.0, 0.0)).norm() < 16.0; });
  TriMesh other = ball_;
  set_thread_count(1);
  update_to_mask(ball_, bump, grid_);
  set_thread_count(8);
  update_to_mask(other, bump, grid_);
  EXPECT_EQ(ball_.points, other.points);
}
TEST_F(FollowMask, SaysWhatItCannotUse) {
  EXPECT_THROW(update_to_mask(ball_, mask_where([](const Vec3&) { return false; }), grid_), Error);
  EXPECT_THROW(update_to_mask(ball_, {1, 0}, grid_), Error);
}

}  // namespace coxa::segment
