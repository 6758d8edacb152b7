#include <coxa/segment/placement.h>

#include <coxa/core/error.h>
#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

shape::Landmarks moved(shape::Landmarks marks, const RigidTransform& X) {
  for (auto& [name, p] : marks) p = X * p;
  return marks;
}

std::string error_of(const shape::Landmarks& marks) {
  try {
    place_by_landmarks(marks, toy::atlas(), 1.0);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST(PlaceByLandmarks, TakesTheAtlasLandmarksToTheGivenOnesWhenTheyAreExact) {
  const auto marks = moved(toy::landmarks_of({1.0, -1.0}), test::some_pose());
  const ThinPlateSpline place = place_by_landmarks(marks, toy::atlas(), 0.0);
  for (const auto& [name, p] : toy::atlas().landmarks)
    EXPECT_LE((place(p) - marks.at(name)).norm(), 1e-6);
}

TEST(PlaceByLandmarks, FollowsNoisyLandmarksLessTheLargerTheirError) {
  auto marks = toy::landmarks_of({});
  marks["mark_0"] += Vec3(0, 6, 0);
  const Vec3 at = toy::atlas().landmarks.at("mark_0");
  const double exact = (place_by_landmarks(marks, toy::atlas(), 0.0)(at) - at).norm();
  const double loose = (place_by_landmarks(marks, toy::atlas(), 6.0)(at) - at).norm();
  EXPECT_NEAR(exact, 6.0, 1e-6);
  EXPECT_LT(loose, 4.5);
}

TEST(PlaceByLandmarks, NamesHowManyItNeedsAndWhichItKnows) {
  auto marks = toy::landmarks_of({});
  while (marks.size() > 5) marks.erase(marks.begin());
  marks["nose"] = Vec3::Zero();
  EXPECT_NE(error_of(marks).find("at least 6 landmarks that the atlas knows, got 5"),
            std::string::npos);
}

TEST(PlaceByLandmarks, RefusesTheOtherSidesLandmarks) {
  EXPECT_NE(error_of(mirrored(toy::landmarks_of({}))).find("other hip"), std::string::npos);
}

TEST(PlaceByLandmarks, RefusesMetresAndInterchangedNames) {
  auto metres = toy::landmarks_of({});
  for (auto& [name, p] : metres) p *= 1e-3;
  EXPECT_NE(error_of(metres).find("times the size"), std::string::npos);
  auto swapped = toy::landmarks_of({});
  for (auto& [name, p] : swapped) p *= 1.3;
  std::swap(swapped["mark_4"], swapped["mark_0"]);
  std::swap(swapped["mark_2"], swapped["mark_3"]);
  EXPECT_NE(error_of(swapped), "");
}

TEST(LandmarksOfSide, TakesTheSuffixedAndTheBareNamesOfOneSide) {
  shape::Landmarks given;
  given["mark_0_right"] = Vec3(1, 0, 0);
  given["mark_0_left"] = Vec3(2, 0, 0);
  given["mark_1"] = Vec3(3, 0, 0);
  given["nose"] = Vec3(4, 0, 0);
  const auto right = landmarks_of_side(given, toy::atlas(), Side::right);
  EXPECT_EQ(right.size(), 2u);
  EXPECT_EQ(right.at("mark_0").x(), 1.0);
  EXPECT_EQ(landmarks_of_side(given, toy::atlas(), Side::left).at("mark_0").x(), 2.0);
}

TEST(LandmarksOfSide, RefusesASetOfTheOtherSide) {
  shape::Landmarks given;
  given["mark_0_left"] = Vec3::Zero();
  EXPECT_THROW(landmarks_of_side(given, toy::atlas(), Side::right), Error);
}

TEST(Mirrored, ImageShowsTheMirroredPlaceAndTwiceIsTheSame) {
  const Volume image = toy::image_of(toy::egg_surface({}, 2),
                                     {.spacing = Vec3::Constant(4.0), .grid = test::some_pose()});
  const Volume mirror = mirrored(image);
  const Vec3 p = image.position(Vec3(5.2, 6.1, 7.3));
  EXPECT_NEAR(sample(mirror, Vec3(-p.x(), p.y(), p.z())), sample(image, p), 1e-9);
  EXPECT_EQ(mirrored(mirror).direction, image.direction);
}

}  // namespace coxa::segment
