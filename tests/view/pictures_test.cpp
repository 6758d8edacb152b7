#include <coxa/view/pictures.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

#include <algorithm>

namespace coxa::view {

// 1 inside a ball of 20 mm around (10, 20, 30), 0 outside; brighter towards the patient's left
Volume ball_volume() {
  Volume volume;
  volume.size = {80, 80, 80};
  volume.origin = Vec3(-29.5, -19.5, -9.5);
  volume.values.resize(static_cast<std::size_t>(volume.n_voxels()));
  for (Index k = 0; k < 80; ++k)
    for (Index j = 0; j < 80; ++j)
      for (Index i = 0; i < 80; ++i) {
        const Vec3 p = volume.position(Vec3(i, j, k)) - Vec3(10, 20, 30);
        volume.values[static_cast<std::size_t>(volume.offset(i, j, k))] =
            p.norm() < 20.0 ? static_cast<float>(100.0 + p[0]) : 0.0f;
      }
  return volume;
}
SurfaceSet ball_surface() { return {{"femur", {test::icosphere(4, 20.0, Vec3(10, 20, 30)), {}}}}; }
const SliceOptions small{.panel = 200, .field = 50.0, .window_low = 0.0, .window_high = 200.0};
constexpr int kTitle = 22;

Index count(const Image& image, Colour colour) {
  return static_cast<Index>(std::count(image.pixels.begin(), image.pixels.end(), colour));
}

TEST(DrawSlices, PutsTheOutlineWhereTheBallEnds) {
  SliceOptions thick = small;
  thick.line_thickness = 4.0;
  const Image image = draw_slices(ball_volume(), ball_surface(), Vec3(10, 20, 30), thick);
  const Colour outline = structure_colour("femur");
  for (int panel = 0; panel < 3; ++panel) {
    const int left = panel * 208;
    // 20 mm are 80 pixels; the outline is a ring of that radius
    EXPECT_EQ(image.at(left + 100 + 80, kTitle + 95), outline);
    EXPECT_EQ(image.at(left + 100 - 80, kTitle + 95), outline);
    EXPECT_EQ(image.at(left + 95, kTitle + 100 - 80), outline);
  }
}
TEST(DrawSlices, ShowsTheVolumeInItsWindowWithThePatientsRightOnTheLeft) {
  const Image image = draw_slices(ball_volume(), {}, Vec3(10, 20, 30), small);
  for (int panel : {0, 1}) {
    // x = 10 ± 10 mm: values 110 and 90 of 0 to 200
    EXPECT_NEAR(image.at(208 * panel + 140, kTitle + 100).r, 110.0 / 200 * 255, 2);
    EXPECT_NEAR(image.at(208 * panel + 60, kTitle + 100).r, 90.0 / 200 * 255, 2);
  }
  EXPECT_NEAR(image.at(208 * 2 + 60, kTitle + 100).r, 100.0 / 200 * 255, 2);
}
TEST(DrawSlices, FindsAWindowWhereNoneIsGiven) {
  const Image image =
      draw_slices(ball_volume(), {}, Vec3(10, 20, 30), {.panel = 200, .field = 50.0});
  EXPECT_GT(image.at(150, kTitle + 100).r, 200);
  EXPECT_EQ(image.at(8, kTitle + 8).r, 0);
}
TEST(DrawSlices, IsBlackOutsideTheVolume) {
  const Image image = draw_slices(ball_volume(), {}, Vec3(10, 20, 300), small);
  EXPECT_EQ(image.at(100, kTitle + 50), kBlack);
}
TEST(DrawSlices, ThickerLinesCoverMore) {
  SliceOptions thick = small;
  thick.line_thickness = 4.0;
  const Colour outline = structure_colour("femur");
  EXPECT_GT(count(draw_slices(ball_volume(), ball_surface(), Vec3(10, 20, 30), thick), outline),
            count(draw_slices(ball_volume(), ball_surface(), Vec3(10, 20, 30), small), outline));
}
TEST(DrawSlices, RejectsEmptyVolumesAndBadOptions) {
  EXPECT_THROW(draw_slices({}, {}, Vec3::Zero()), Error);
  EXPECT_THROW(draw_slices(ball_volume(), {}, Vec3::Zero(), {.panel = 10}), Error);
  EXPECT_THROW(draw_slices(ball_volume(), {}, Vec3::Zero(), {.field = 0.0}), Error);
  EXPECT_THROW(draw_slices(ball_volume(), {}, Vec3::Zero(), {.line_thickness = 0.0}), Error);
  EXPECT_THROW(draw_slices(ball_volume(), {}, Vec3(kNaN, 0, 0)), Error);
}

SurfaceSet two_balls() {
  // the femur in front of the hip bone
  return {{"femur", {test::icosphere(3, 10.0, Vec3(0, -30, 0)), {}}},
          {"hip_bone", {test::icosphere(3, 10.0, Vec3(0, 30, 0)), {}}}};
}
// hue of a shaded pixel: is blue above red?
bool bluish(Colour c) { return c.b > c.r; }

TEST(DrawSurfaces, ShowsEachSideFromItsViewpoint) {
  const Image image = draw_surfaces(
      two_balls(),
      {.viewpoints = {Viewpoint::anterior, Viewpoint::posterior, Viewpoint::left}, .panel = 200});
  EXPECT_FALSE(bluish(image.at(100, kTitle + 100)));
  EXPECT_TRUE(bluish(image.at(208 + 100, kTitle + 100)));
  // from the patient's left the front is on the left
  EXPECT_FALSE(bluish(image.at(416 + 40, kTitle + 100)));
  EXPECT_TRUE(bluish(image.at(416 + 160, kTitle + 100)));
}
TEST(DrawSurfaces, StructuresSeenThroughLetOthersShow) {
  const SurfacePictureOptions solid{.viewpoints = {Viewpoint::anterior}, .panel = 200};
  SurfacePictureOptions clear = solid;
  clear.see_through = {"femur"};
  EXPECT_GT(draw_surfaces(two_balls(), clear).at(100, kTitle + 100).b,
            draw_surfaces(two_balls(), solid).at(100, kTitle + 100).b + 20);
}
TEST(DrawSurfaces, RejectsNothingToShow) {
  EXPECT_THROW(draw_surfaces({}), Error);
  EXPECT_THROW(draw_surfaces(two_balls(), {.viewpoints = {}}), Error);
  EXPECT_THROW(draw_surfaces(two_balls(), {.panel = 20}), Error);
}
TEST(DrawField, ColoursBothKindsOfValues) {
  const TriMesh mesh = test::icosphere(3);
  const ColourScale scale{.low = -10.0, .high = 10.0, .label = "x [mm]"};
  const Image image = draw_field(mesh, mesh.points.col(0), scale, Viewpoint::anterior, 300);
  const Colour middle = image.at(150, 150), expected = scale_colour(scale, 0.0);
  EXPECT_NEAR(middle.g, expected.g, 6);
  EXPECT_GT(image.at(230, 150).g,
            image.at(70, 150).g);  // yellow on the patient's left, right in the picture
  EXPECT_NO_THROW(
      draw_field(mesh, VecX::Zero(mesh.n_triangles()), scale, Viewpoint::superior, 120));
  EXPECT_THROW(draw_field(mesh, VecX::Zero(3), scale, Viewpoint::anterior), Error);
}

// half of a sphere around the origin on the patient's left side, seen from the origin
TriMesh socket() {
  TriMesh mesh = test::icosphere(4, 25.0);
  std::vector<Eigen::Matrix<Index, 1, 3>> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (mesh.points(mesh.triangles.row(t), 0).minCoeff() > 0.0)
      kept.push_back(mesh.triangles.row(t));
  mesh.triangles.resize(static_cast<Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) mesh.triangles.row(static_cast<Index>(i)) = kept[i];
  return mesh;
}

TEST(StrainMapPanel, ShowsEveryFrameWithTheSameColours) {
  const TriMesh mesh = socket();
  const std::vector<MapFrame> frames{{"first", mesh.points.col(1)},
                                     {"second", VecX::Constant(mesh.n_vertices(), 25.0)}};
  const ColourScale scale{.low = -25.0, .high = 25.0, .label = "y [mm]"};
  const Image image = strain_map_panel(mesh, Vec3::Zero(), frames, scale, 200);
  // looking towards the patient's left with superior up, anterior (-y) is on the right
  EXPECT_GT(image.at(50, kTitle + 100).g, image.at(150, kTitle + 100).g);
  EXPECT_NEAR(image.at(100, kTitle + 100).g, scale_colour(scale, 0.0).g, 8);
  EXPECT_NEAR(image.at(210 + 100, kTitle + 100).g, scale_colour(scale, 25.0).g, 8);
}
TEST(StrainMapPanel, RejectsFramesThatDoNotFit) {
  const TriMesh mesh = socket();
  EXPECT_THROW(strain_map_panel(mesh, Vec3::Zero(), {}, {}), Error);
  EXPECT_THROW(strain_map_panel(mesh, Vec3::Zero(), {{"", VecX::Zero(2)}}, {}), Error);
  EXPECT_THROW(strain_map_panel({}, Vec3::Zero(), {{"", VecX()}}, {}), Error);
}
TEST(ScaleFor, SpansAllFramesWithoutTheTopPercentAndWithoutGaps) {
  VecX ramp = VecX::LinSpaced(101, 0.0, 100.0), holes = ramp;
  holes[3] = kNaN;
  const ColourScale scale = scale_for({{"", ramp}, {"", holes}}, "label");
  EXPECT_EQ(scale.low, 0.0);
  EXPECT_NEAR(scale.high, 99.0, 1.0);
  EXPECT_EQ(scale.label, "label");
  const ColourScale none = scale_for({{"", VecX::Constant(5, kNaN)}}, "");
  EXPECT_LT(none.low, none.high);
  const ColourScale flat = scale_for({{"", VecX::Constant(5, 7.0)}}, "");
  EXPECT_LT(flat.low, flat.high);
}
TEST(Pictures, AreBitIdenticalForOneAndEightThreads) {
  const auto run = [] {
    return draw_slices(ball_volume(), ball_surface(), Vec3(10, 20, 30), small).pixels;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}

}  // namespace coxa::view
