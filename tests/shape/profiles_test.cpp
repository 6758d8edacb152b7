#include <coxa/shape/profiles.h>

#include <coxa/core/error.h>
#include <coxa/shape/virtual_hip.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

/// Grey values rising across the plane x = 0, as gain * tanh(x) + offset.
Volume edge_image(double gain, double offset) {
  Volume image;
  image.size = {41, 21, 21};
  image.origin = Vec3(-20.0, -10.0, -10.0);
  for (std::int64_t i = 0; i < image.n_voxels(); ++i) {
    const double x = -20.0 + static_cast<double>(i % 41);
    image.values.push_back(static_cast<float>(gain * std::tanh(x) + offset));
  }
  return image;
}

ProfileExample at_origin(const Volume& image) {
  ProfileExample example{&image, Points::Zero(1, 3), Points::Zero(1, 3)};
  example.normals.row(0) = Vec3::UnitX();
  return example;
}

TEST(Profiles, DoNotDependOnGainAndOffset) {
  const Volume a = edge_image(10.0, 100.0), b = edge_image(55.0, 70.0);
  const ProfileSet one = learn_profiles({at_origin(a)}, "t1");
  const ProfileSet other = learn_profiles({at_origin(b)}, "t1");
  EXPECT_LT((one.mean - other.mean).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(one.mean.row(0).sum(), 0.0, 1e-9);
  EXPECT_NEAR(one.mean.row(0).norm(), 1.0, 1e-9);
  EXPECT_GT(one.mean(0, one.n_inside + 2), one.mean(0, one.n_inside - 2));
}

TEST(Profiles, AreReliableWhereExamplesAgree) {
  const Volume up = edge_image(10.0, 100.0), down = edge_image(-10.0, 100.0);
  EXPECT_NEAR(learn_profiles({at_origin(up), at_origin(up)}, "t1").reliability[0], 1.0, 1e-9);
  EXPECT_NEAR(learn_profiles({at_origin(up), at_origin(down)}, "t1").reliability[0], 0.0, 1e-5);
}

TEST(Profiles, SayNothingWhereTheImageIsFlatOrEnds) {
  const Volume flat = edge_image(0.0, 100.0), edge = edge_image(10.0, 100.0);
  EXPECT_EQ(learn_profiles({at_origin(flat)}, "t1").reliability[0], 0.0);
  ProfileExample outside = at_origin(edge);
  outside.points(0, 0) = 18.0;
  EXPECT_EQ(learn_profiles({outside}, "t1").reliability[0], 0.0);
}

TEST(Profiles, HaveTheSamplesAskedFor) {
  const Volume edge = edge_image(10.0, 100.0);
  const ProfileSet set =
      learn_profiles({at_origin(edge)}, "t1", {.step = 1.0, .n_inside = 3, .n_outside = 5});
  EXPECT_EQ(set.mean.cols(), 9);
  EXPECT_EQ(set.n_inside, 3);
  EXPECT_EQ(set.step, 1.0);
}

TEST(Profiles, OfAnAtlasComeInOneSetPerClassOfImages) {
  Atlas atlas = test::toy_atlas();
  const VirtualHip hip = mean_hip(atlas);
  const Volume image = edge_image(10.0, 100.0);
  update_profiles(atlas, {{"t1", &hip, &image}, {"dess", &hip, &image}});
  for (const StructureModel& model : atlas.structures) {
    ASSERT_EQ(model.profiles.size(), 2u);
    EXPECT_EQ(model.profiles[0].contrast, "dess");
    EXPECT_EQ(model.profiles[0].mean.rows(), model.hierarchy.levels.back().n_vertices());
  }
}

TEST(Profiles, RefuseExamplesThatDiffer) {
  const Volume edge = edge_image(10.0, 100.0);
  ProfileExample two = at_origin(edge);
  two.points = Points::Zero(2, 3);
  EXPECT_THROW(learn_profiles({at_origin(edge), two}, "t1"), Error);
  EXPECT_THROW(learn_profiles({}, "t1"), Error);
  EXPECT_THROW(learn_profiles({at_origin(edge)}, "t1", {.step = 0.0}), Error);
}

}  // namespace
}  // namespace coxa::shape
