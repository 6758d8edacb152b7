#include <coxa/view/render.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa::view {

const Camera from_front{
    .target = Vec3(5, 6, 7), .direction = Vec3::UnitY(), .up = Vec3::UnitZ(), .view_height = 40.0};

SceneMesh ball(Colour colour, double radius = 10.0, const Vec3& centre = Vec3(5, 6, 7)) {
  return {.mesh = test::icosphere(4, radius, centre), .colour = colour, .relief = 0.0};
}
Image picture(const std::vector<SceneMesh>& scene,
              const RenderOptions& options = {.width = 200, .height = 100}) {
  return render(scene, from_front, options);
}

TEST(Render, ShowsABallAsADiscOfItsSize) {
  const Image image = picture({ball({255, 0, 0})});
  int red = 0;
  for (const Colour& c : image.pixels) red += c.g < 128;
  const double radius = 10.0 / 40.0 * 100;
  EXPECT_NEAR(red, kPi * radius * radius, 0.01 * kPi * radius * radius);
  EXPECT_EQ(image.at(100, 50), (Colour{255, 0, 0}));
  EXPECT_EQ(image.at(5, 5), kWhite);
}
TEST(Render, ProjectsPointsWhereTheyAreSeen) {
  // right in a picture from the front is the patient's left: +x in LPS
  const Image image =
      picture({ball({255, 0, 0}, 2.0, Vec3(15, 0, 7)), ball({0, 0, 255}, 2.0, Vec3(5, 0, 20))});
  const Vec2 red = project(from_front, Vec3(15, 0, 7), 200, 100),
             blue = project(from_front, Vec3(5, 0, 20), 200, 100);
  EXPECT_EQ(red, Vec2(125, 50));
  EXPECT_EQ(blue, Vec2(100, 17.5));
  EXPECT_EQ(image.at(125, 50), (Colour{255, 0, 0}));
  EXPECT_EQ(image.at(100, 17), (Colour{0, 0, 255}));
}
TEST(Render, NearerSurfacesHideFartherOnes) {
  const SceneMesh near = ball({255, 0, 0}, 3.0, Vec3(5, -20, 7)),
                  far = ball({0, 0, 255}, 3.0, Vec3(5, 30, 7));
  EXPECT_EQ(picture({near, far}).at(100, 50), (Colour{255, 0, 0}));
  EXPECT_EQ(picture({far, near}).at(100, 50), (Colour{255, 0, 0}));
}
TEST(Render, TransparentSurfacesMixByOpacity) {
  SceneMesh glass = ball({255, 0, 0}, 3.0, Vec3(5, -20, 7));
  glass.opacity = 0.5;
  // front and back wall of the glass ball: 1/2 red, 1/4 red, the rest blue
  EXPECT_EQ(picture({glass, ball({0, 0, 255}, 3.0, Vec3(5, 30, 7))}).at(100, 50),
            (Colour{191, 0, 64}));
}
TEST(Render, ColoursByValuesPerVertexOrTriangle) {
  SceneMesh part = ball(kBlack);
  part.scale = {.low = -3.0, .high = 17.0, .label = "z"};
  part.vertex_values = part.mesh.points.col(2);
  for (int y : {30, 50, 70}) {
    const double z = 7.0 + (50.0 - y - 0.5) * 0.4;
    const Colour expected = scale_colour(part.scale, z), seen = picture({part}).at(100, y);
    EXPECT_NEAR(seen.r, expected.r, 2);
    EXPECT_NEAR(seen.g, expected.g, 2);
    EXPECT_NEAR(seen.b, expected.b, 2);
  }
  part.vertex_values.resize(0);
  part.triangle_values = VecX::Constant(part.mesh.n_triangles(), 7.0);
  EXPECT_EQ(picture({part}).at(100, 50), map_colour(ColourMap::viridis, 0.5));
}
TEST(Render, ReliefDarkensWhatIsSeenEdgeOn) {
  SceneMesh part = ball(kWhite);
  part.relief = 1.0;
  const Image image = picture({part}, {.width = 200, .height = 100, .background = kBlack});
  EXPECT_GT(image.at(100, 50).r, 250);
  // at 0.8 radius the normal leans by asin 0.8: cosine 0.6
  EXPECT_NEAR(image.at(120, 50).r, 0.57 * 255, 8);
}
TEST(Render, MoreSamplesSmoothTheEdge) {
  const auto shades = [](const Image& image) {
    int n = 0;
    for (const Colour& c : image.pixels) n += c.g > 5 && c.g < 250;
    return n;
  };
  EXPECT_EQ(shades(picture({ball({255, 0, 0})}, {.width = 200, .height = 100, .samples = 1})), 0);
  EXPECT_GT(shades(picture({ball({255, 0, 0})}, {.width = 200, .height = 100, .samples = 3})), 100);
}
TEST(CameraFor, ShowsAllPointsInEitherShape) {
  const Points points = test::random_points(100, 30.0, 3);
  for (double aspect : {0.5, 1.0, 2.0}) {
    const Camera camera = camera_for(points, Vec3(1, 2, -0.5), Vec3::UnitZ(), aspect);
    EXPECT_NEAR(camera.direction.norm(), 1.0, 1e-14);
    EXPECT_NEAR(camera.up.dot(camera.direction), 0.0, 1e-14);
    double least = kInfinity;
    for (Index i = 0; i < 100; ++i) {
      const Vec2 p = project(camera, points.row(i), static_cast<int>(1000 * aspect), 1000);
      EXPECT_GT(p.minCoeff(), 0.0);
      EXPECT_LT(p[0], 1000 * aspect);
      EXPECT_LT(p[1], 1000);
      least = std::min({least, p[0], p[1]});
    }
    EXPECT_LT(least, 40.0);  // and not much more than them
  }
  EXPECT_THROW(camera_for(points, Vec3::UnitZ(), Vec3::UnitZ(), 1.0), Error);
  EXPECT_THROW(camera_for(Points(0, 3), Vec3::UnitY(), Vec3::UnitZ(), 1.0), Error);
}
TEST(Render, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] {
    return picture({ball({200, 30, 40}), ball({0, 0, 255}, 4.0, Vec3(15, 0, 7))}).pixels;
  };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(Render, AnEmptySceneIsBackground) { EXPECT_EQ(picture({}).at(3, 3), kWhite); }
TEST(Render, RejectsValuesThatDoNotFitAndBadOptions) {
  SceneMesh part = ball(kBlack);
  part.vertex_values = VecX::Zero(3);
  EXPECT_THROW(picture({part}), Error);
  part = ball(kBlack);
  part.opacity = 1.5;
  EXPECT_THROW(picture({part}), Error);
  part = ball(kBlack);
  part.mesh.triangles(0, 0) = 1 << 20;
  EXPECT_THROW(picture({part}), Error);
  EXPECT_THROW(picture({}, {.width = 0}), Error);
  EXPECT_THROW(picture({}, {.samples = 0}), Error);
}

}  // namespace coxa::view
