#include <coxa/view/colour_map.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include <cmath>

namespace coxa::view {

// CIE lightness of an sRGB colour
double lightness(Colour c) {
  const auto linear = [](double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const double y =
      0.2126 * linear(c.r / 255.0) + 0.7152 * linear(c.g / 255.0) + 0.0722 * linear(c.b / 255.0);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(ColourMap, EndsAreThePublishedOnes) {
  EXPECT_EQ(map_colour(ColourMap::viridis, 0.0), (Colour{68, 1, 84}));
  EXPECT_EQ(map_colour(ColourMap::viridis, 1.0), (Colour{253, 231, 37}));
  EXPECT_EQ(map_colour(ColourMap::viridis, 7.0), (Colour{253, 231, 37}));
  EXPECT_EQ(map_colour(ColourMap::cividis, -1.0), (Colour{0, 34, 78}));
  EXPECT_EQ(map_colour(ColourMap::grey, 0.5), (Colour{128, 128, 128}));
}
TEST(ColourMap, LightnessRisesEvenly) {
  for (ColourMap map : {ColourMap::viridis, ColourMap::cividis}) {
    const double low = lightness(map_colour(map, 0.0)), high = lightness(map_colour(map, 1.0));
    for (double share = 0.0; share <= 1.0; share += 0.05)
      EXPECT_NEAR(lightness(map_colour(map, share)), low + share * (high - low), 3.5);
  }
}
TEST(ColourMap, NoValueIsGreyAndNotAColourOfTheMap) {
  const Colour none = map_colour(ColourMap::viridis, kNaN);
  EXPECT_EQ(none.r, none.g);
  EXPECT_EQ(none.g, none.b);
}
TEST(ColourScale, PlacesValuesInItsRange) {
  const ColourScale scale{.low = 2.0, .high = 6.0, .label = "x"};
  EXPECT_EQ(scale_colour(scale, 4.0), map_colour(ColourMap::viridis, 0.5));
}
TEST(NiceTicks, AreRoundAndInside) {
  EXPECT_EQ(nice_ticks(0.0, 1.0),
            (std::vector<double>{0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0}));
  const auto ticks = nice_ticks(-3.7, 11.2, 6);
  EXPECT_EQ(ticks, (std::vector<double>{-2, 0, 2, 4, 6, 8, 10}));
  EXPECT_THROW(nice_ticks(1.0, 1.0), Error);
  EXPECT_THROW(nice_ticks(0.0, kNaN), Error);
  EXPECT_THROW(nice_ticks(0.0, 1.0, 0), Error);
  EXPECT_EQ(tick_label(0.6000000000000001, 0.2), "0.6");
  EXPECT_EQ(tick_label(150.0, 50.0), "150");
  EXPECT_EQ(tick_label(0.001, 0.001), "0.001");
}
TEST(ColourBar, ShowsTheColoursOfItsRangeTopDown) {
  const ColourScale scale{.low = 0.0, .high = 3.0, .label = "pressure [MPa]"};
  const Image bar = draw_colour_bar(scale, 300);
  EXPECT_EQ(bar.at(10, 282), map_colour(ColourMap::viridis, 0.5 / 249));
  EXPECT_EQ(bar.at(10, 34), map_colour(ColourMap::viridis, 1.0 - 0.5 / 249));
  EXPECT_THROW(draw_colour_bar({.low = 1.0, .high = 1.0, .label = ""}, 300), Error);
  EXPECT_THROW(draw_colour_bar(scale, 30), Error);
}
TEST(StructureColour, DiffersBetweenTheStructuresOfTheJoint) {
  const auto names = {"femur",
                      "hip_bone",
                      "femoral_cartilage",
                      "acetabular_cartilage",
                      "acetabular_labrum",
                      "iliofemoral_ligament"};
  for (const char* a : names)
    for (const char* b : names)
      EXPECT_EQ(structure_colour(a) == structure_colour(b), std::string(a) == b);
  EXPECT_EQ(structure_colour("gluteus_maximus"), structure_colour("gluteus_maximus"));
  EXPECT_EQ(readable("femoral_cartilage"), "femoral cartilage");
}

}  // namespace coxa::view
