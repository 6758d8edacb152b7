#include <coxa/segment/pins.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace coxa::segment {
namespace {

const std::map<std::string, std::string> kHosts{{"layer", "bone"}};

/// A ball of 40 mm with a shell of 2 mm on it.
SurfaceSet ball_with_layer() {
  SurfaceSet set;
  set["bone"].mesh = test::icosphere(5, 40.0);
  set["layer"].mesh =
      test::together(test::turned_over(test::icosphere(5, 40.05)), test::icosphere(5, 42.0));
  return set;
}
double distance(const TriMesh& mesh, const Vec3& p) {
  return std::sqrt(TriangleTree(mesh.points, mesh.triangles).nearest(p).squared_distance);
}
Vec3 out(const Vec3& direction, double radius) { return radius * direction.normalized(); }

const std::vector<Pin> kPins{{"bone-1", "bone", out({1, 0.2, 0.1}, 43.5)},
                             {"bone-2", "bone", out({1, 0.5, 0.1}, 38.0)},
                             {"layer-1", "layer", out({-1, 0.3, 0.2}, 43.0)}};

TEST(Pins, AreOnTheSurfaceAndLeaveWhatIsFar) {
  SurfaceSet set = ball_with_layer();
  const SurfaceSet before = set;
  const auto left = update_pinned(set, kPins, kHosts, 0.02);
  for (const Pin& pin : kPins) {
    EXPECT_LT(distance(set[pin.structure].mesh, pin.place), 0.3) << pin.name;
    EXPECT_NEAR(distance(set[pin.structure].mesh, pin.place), left.at(pin.name), 1e-9);
    EXPECT_GT(distance(before.at(pin.structure).mesh, pin.place), 0.9) << pin.name;
  }
  for (const char* name : {"bone", "layer"}) {
    Index far = 0, moved = 0;
    for (Index v = 0; v < set[name].mesh.n_vertices(); ++v) {
      const Vec3 old = before.at(name).mesh.points.row(v), now = set[name].mesh.points.row(v);
      double nearest = kInfinity;
      for (const Pin& pin : kPins) nearest = std::min(nearest, (old - pin.place).norm());
      if (nearest > 34.0) {  // 30 mm and the way to the surface
        ++far;
        EXPECT_EQ(now, old) << name;
      }
      if (now != old) ++moved;
    }
    EXPECT_GT(far, 1000) << name;
    EXPECT_GT(moved, 300) << name;
  }
}
TEST(Pins, CarryTheLayerWithItsBone) {
  SurfaceSet set = ball_with_layer();
  update_pinned(set, {kPins[0]}, kHosts, 0.02);
  const Vec3 beneath = out({1, 0.2, 0.1}, 43.5);
  EXPECT_NEAR(distance(set["layer"].mesh, out(beneath, 43.5 + 0.05)), 0.0, 0.1);
  EXPECT_NEAR(distance(set["layer"].mesh, out(beneath, 43.5 + 2.0)), 0.0, 0.15);
}
TEST(Pins, MoveOneSideOfAThinSheet) {
  SurfaceSet set;
  set["sheet"].mesh =
      test::together(test::turned_over(test::icosphere(5, 38.0)), test::icosphere(5, 40.0));
  const SurfaceSet before = set;
  update_pinned(set, {{"sheet-1", "sheet", out({0, 0, 1}, 42.0)}}, {}, 0.0);
  EXPECT_LT(distance(set["sheet"].mesh, out({0, 0, 1}, 42.0)), 0.01);
  EXPECT_LT(distance(set["sheet"].mesh, out({0, 0, 1}, 38.0)), 0.05);
}
TEST(Pins, GoAsFarAsTheirWeightSays) {
  SurfaceSet set = ball_with_layer();
  update_pinned(set, {{"a-1", "bone", out({0, 0, 1}, 44.0), 0.5}}, {}, 0.0);
  EXPECT_NEAR(distance(set["bone"].mesh, out({0, 0, 1}, 42.0)), 0.0, 0.05);
}
TEST(Pins, AtOnePlaceShareWhatTheyAskFor) {
  SurfaceSet set = ball_with_layer();
  const auto left = update_pinned(
      set, {{"a", "bone", out({0, 0, 1}, 42.0)}, {"b", "bone", out({0, 0, 1}, 44.0)}}, {}, 0.0);
  EXPECT_NEAR(left.at("a"), 1.0, 0.05);
  EXPECT_NEAR(left.at("b"), 1.0, 0.05);
}
TEST(Pins, AreTheSameWithAnyNumberOfThreads) {
  const auto pinned = [] {
    SurfaceSet set = ball_with_layer();
    update_pinned(set, kPins, kHosts, 0.02);
    return set;
  };
  const SurfaceSet one = with_threads(1, pinned), eight = with_threads(8, pinned);
  for (const char* name : {"bone", "layer"})
    EXPECT_EQ(one.at(name).mesh.points, eight.at(name).mesh.points);
}
TEST(Pins, SayWhatIsWrongWithThem) {
  const auto refused = [](const Pin& pin) {
    SurfaceSet set = ball_with_layer();
    try {
      update_pinned(set, {pin}, kHosts, 0.02);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused({"femur-1", "femur", {0, 0, 0}}).find("femur, which is not segmented"),
            std::string::npos);
  EXPECT_NE(refused({"bone-1", "bone", {0, 0, 0}}).find("taken up to 15 mm"), std::string::npos);
  EXPECT_NE(refused({"bone-1", "bone", {40, 0, 0}, 2.0}).find("in [0, 1]"), std::string::npos);
}

}  // namespace
}  // namespace coxa::segment
