#include <coxa/shape/build_atlas.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/validate.h>
#include <coxa/shape/virtual_hip.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

TEST(BuildAtlas, GivesEveryStructureItsResolutionsAndModes) {
  const Atlas& atlas = test::toy_atlas();
  ASSERT_EQ(atlas.structures.size(), 4u);
  EXPECT_EQ(atlas.subjects, (std::vector<std::string>{"toy/1", "toy/2", "toy/3"}));
  for (const StructureModel& model : atlas.structures) {
    // a level coarser than 200 triangles is not made
    EXPECT_GE(model.hierarchy.levels.size(), 2u) << model.name;
    EXPECT_LE(model.hierarchy.levels.size(), 3u) << model.name;
    const Index n = model.hierarchy.levels.back().n_vertices();
    EXPECT_EQ(model.shape.modes.rows(), 3 * n);
    EXPECT_GE(model.shape.deviations.size(), 1);
    EXPECT_LE(model.shape.deviations.size(), 2);
    EXPECT_EQ(model.reference.size(), static_cast<std::size_t>(n));
  }
}

TEST(BuildAtlas, FindsHowTheFemursVary) {
  // heads of 12, 12.5 and 12.2 mm: after taking out size, the rod's thickness is what varies
  const StructureModel& femur = structure(test::toy_atlas(), "femur");
  const auto n = static_cast<double>(femur.hierarchy.levels.back().n_vertices());
  EXPECT_GT(femur.shape.deviations[0] / std::sqrt(n), 0.05);
  EXPECT_LT(femur.shape.deviations[0] / std::sqrt(n), 0.5);
}

TEST(BuildAtlas, PairsTheTwoSidesOfACartilage) {
  const StructureModel& model = structure(test::toy_atlas(), "femoral_cartilage");
  const SimplexMesh& mesh = model.hierarchy.levels.back();
  ASSERT_EQ(2 * model.n_bone_side, mesh.n_vertices());
  for (Index v = 0; v < model.n_bone_side; ++v) {
    const double bone = mesh.points.row(v).norm();
    const double joint = mesh.points.row(v + model.n_bone_side).norm();
    EXPECT_GT(joint, bone);
    EXPECT_LT(joint - bone, 2.2);
  }
}

TEST(BuildAtlas, LaysTheMeanCartilagesOnTheMeanBonesWithoutEnteringThem) {
  const VirtualHip mean = mean_hip(test::toy_atlas());
  for (const char* name : {"femoral_cartilage", "acetabular_cartilage"}) {
    const TriMesh& bone = mean.at(bone_under(name));
    const TriangleTree tree(bone.points, bone.triangles);
    const Index n = structure(test::toy_atlas(), name).n_bone_side;
    const TriMesh& cartilage = mean.at(name);
    for (Index t = 0; t < n; ++t) {
      const Index v = cartilage.triangles(t, 0);
      const double distance = tree.signed_distance(cartilage.points.row(v));
      EXPECT_GT(distance, -0.02) << name;
      EXPECT_LT(distance, 0.25) << name;
    }
  }
}

TEST(BuildAtlas, MakesSoundSurfaces) {
  for (const auto& [name, mesh] : mean_hip(test::toy_atlas()))
    EXPECT_TRUE(validate(mesh).valid()) << name << ": " << validate(mesh).text();
}

TEST(BuildAtlas, TakesTheBonesWordWhereACartilagesSidesAreNotMarked) {
  std::vector<HipExample> hips = test::toy_hips();
  for (HipExample& hip : hips) hip.bone_side_faces.clear();
  AtlasOptions options = test::toy_options();
  const Atlas atlas = build_atlas(hips, options);
  const StructureModel& marked = structure(test::toy_atlas(), "femoral_cartilage");
  EXPECT_NEAR(structure(atlas, "femoral_cartilage").n_bone_side, marked.n_bone_side, 6);
  for (HipExample& hip : hips) hip.surfaces.erase("femur");
  hips[0].surfaces["femur"] = test::toy_hips()[0].surfaces["femur"];
  EXPECT_THROW(build_atlas(hips, options), Error);
}

TEST(BuildAtlas, ACartilageGapMovesTheMeanCartilageOffItsBone) {
  AtlasOptions options = test::toy_options();
  options.cartilage_gap = 0.5;
  const Atlas atlas = build_atlas(test::toy_hips(), options);
  const auto radius = [](const Atlas& a) {
    const StructureModel& model = structure(a, "femoral_cartilage");
    return model.hierarchy.levels.back().points.topRows(model.n_bone_side).rowwise().norm().mean();
  };
  EXPECT_NEAR(radius(atlas) - radius(test::toy_atlas()), 0.45, 0.1);
}

TEST(BuildAtlas, NamesWhatIsMissing) {
  std::vector<HipExample> hips = test::toy_hips();
  for (HipExample& hip : hips) hip.surfaces.erase("hip_bone");
  try {
    build_atlas(hips, test::toy_options());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("hip_bone"), std::string::npos);
  }
  AtlasOptions options = test::toy_options();
  options.structures["femur"].edge = 0.0;
  EXPECT_THROW(build_atlas(test::toy_hips(), options), Error);
  options = test::toy_options();
  options.structures["femur"].n_levels = 2;
  EXPECT_THROW(build_atlas(test::toy_hips(), options), Error);
  EXPECT_THROW(structure(test::toy_atlas(), "patella"), Error);
}

}  // namespace
}  // namespace coxa::shape
