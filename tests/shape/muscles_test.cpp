#include <coxa/shape/muscles.h>

#include <coxa/core/error.h>
#include <coxa/shape/virtual_hip.h>
#include <gtest/gtest.h>

#include "toy_hip.h"

namespace coxa::shape {
namespace {

TriMesh muscle() {
  TriMesh mesh = test::ellipsoid({0.5, 0.4, 1.2});
  mesh.points.rowwise() += Vec3(9.0, 3.0, -12.0).transpose();
  return mesh;
}

/// The atlas' mean bones and a muscle, all of another size, the muscle fuller by `growth` mm.
HipExample example(int number, double scale, double growth) {
  HipExample hip;
  hip.name = "toy/" + std::to_string(number);
  const VirtualHip mean = mean_hip(test::toy_atlas());
  for (const char* bone : {"femur", "hip_bone"}) {
    hip.surfaces[bone].mesh = mean.at(bone);
    hip.surfaces[bone].mesh.points *= scale;
  }
  TriMesh mesh = muscle();
  const Vec3 centre = mesh.points.colwise().mean().transpose();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 out = (mesh.points.row(v).transpose() - centre).normalized();
    mesh.points.row(v) = scale * (mesh.points.row(v) + growth * out.transpose());
  }
  hip.surfaces["thick"].mesh = mesh;
  return hip;
}

MuscleOptions options() {
  MuscleOptions o;
  o.triangle_area = 2.0;
  o.least_triangles = 300;
  o.control_spacing = 5.0;
  o.control_smoothness = 0.1;
  o.registration.lengths = {10.0, 4.0, 2.0};
  return o;
}

TEST(MuscleModels, HoldWhatTheBonesDoNotExplain) {
  Atlas atlas = test::toy_atlas();
  const auto before = atlas.structures.size();
  const auto carried =
      add_muscles(atlas, {example(1, 1.0, -0.5), example(2, 1.1, 0.0), example(3, 0.95, 0.5)},
                  {"thick", "absent"}, options());
  ASSERT_EQ(atlas.structures.size(), before + 1);
  const StructureModel& model = atlas.structures.back();
  EXPECT_TRUE(model.muscle);
  EXPECT_GE(model.hierarchy.levels.size(), 2u);  // small: no coarser one
  ASSERT_EQ(carried.size(), 3u);
  // size is taken out: the middle of every example lies where the first one's does
  const Vec3 centre = muscle().points.colwise().mean().transpose();
  for (const CarriedMuscles& hip : carried) {
    const Vec3 middle = hip.surfaces.at("thick").points.colwise().mean().transpose();
    EXPECT_LT((middle - centre).norm(), 0.6) << hip.name;
  }
  // fullness is not: it is in the examples, and the mean is between them
  const auto reach = [&](const Points& p) {
    return (p.rowwise() - centre.transpose()).rowwise().norm().mean();
  };
  const double thin = reach(carried[0].surfaces.at("thick").points);
  const double full = reach(carried[2].surfaces.at("thick").points);
  EXPECT_NEAR(full - thin, 1.0, 0.3);
  EXPECT_NEAR(reach(dual_surface(model.hierarchy.levels.back()).points), 0.5 * (thin + full), 0.3);
}

TEST(MuscleModels, AreNoBonesOfVirtualHips) {
  Atlas atlas = test::toy_atlas();
  Rng a(5), b(5);
  const VirtualHip without = draw_virtual_hip(atlas, a);
  add_muscles(atlas, {example(1, 1.0, 0.0)}, {"thick"}, options());
  const VirtualHip with = draw_virtual_hip(atlas, b);
  ASSERT_EQ(with.size(), without.size());
  for (const auto& [name, mesh] : without) EXPECT_EQ(mesh.points, with.at(name).points) << name;
}

TEST(MuscleModels, OptionsOutOfRangeAreRefused) {
  Atlas atlas = test::toy_atlas();
  MuscleOptions bad = options();
  bad.n_levels = 2;
  EXPECT_THROW(add_muscles(atlas, {}, {"thick"}, bad), Error);
}

}  // namespace
}  // namespace coxa::shape
