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

/// The one structure's points.
Points place(const shape::Landmarks& marks, double error) {
  static const shape::Atlas atlas = toy::atlas();
  return place_by_landmarks({&atlas.structures.front()}, marks, atlas, error).front();
}

std::string error_of(const shape::Landmarks& marks) {
  try {
    place(marks, 1.0);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST(PlaceByLandmarks, PutsTheMeanShapeWhereExactLandmarksOfItAre) {
  const RigidTransform X = test::some_pose();
  const Points mean = toy::points_of({}, 3);
  const Points placed = place(moved(toy::landmarks_of({}), X), 0.0);
  EXPECT_LE((placed - transformed(mean, X)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(PlaceByLandmarks, BendsTheShapeTowardsItsLandmarks) {
  const toy::Egg egg{2.0, -2.0};
  const Points truth = toy::points_of(egg, 3), mean = toy::points_of({}, 3);
  const Points placed = place(toy::landmarks_of(egg), 0.0);
  EXPECT_LT((placed - truth).norm(), 0.5 * (mean - truth).norm());
}

TEST(PlaceByLandmarks, FollowsANoisyLandmarkLessTheLargerTheirError) {
  auto marks = toy::landmarks_of({});
  const Points before = place(marks, 0.0);
  marks["mark_0"] += Vec3(0, 6, 0);
  const double exact = (place(marks, 0.0) - before).rowwise().norm().maxCoeff();
  const double loose = (place(marks, 6.0) - before).rowwise().norm().maxCoeff();
  EXPECT_LT(loose, 0.8 * exact);
}

TEST(PlaceByLandmarks, TurnsEachBoneByItsOwnLandmarks) {
  // a second egg beside the first, with eight landmarks of its own
  shape::Atlas atlas = toy::atlas();
  shape::StructureModel other = atlas.structures.front();
  const Vec3 beside(90.0, 0.0, 0.0);
  for (auto& level : other.hierarchy.levels) level.points.rowwise() += beside.transpose();
  const RigidTransform turn{rotation_from_vector(Vec3(0.0, 0.4, 0.0)), Vec3::Zero()};
  shape::Landmarks marks = atlas.landmarks;
  for (const auto& [name, p] : toy::landmarks_of({})) {
    atlas.landmarks["other_" + name] = p + beside;
    marks["other_" + name] = turn * p + beside;
  }
  const auto placed = place_by_landmarks({&atlas.structures.front(), &other}, marks, atlas, 3.0);
  const Points mean = toy::points_of({}, 3);
  // size is common to both and fitted to all landmarks, which the turn brings a little nearer
  // together
  EXPECT_LE((placed[0] - mean).cwiseAbs().maxCoeff(), 0.05);
  const Points turned = transformed(mean, turn).rowwise() + beside.transpose();
  EXPECT_LE((placed[1] - turned).cwiseAbs().maxCoeff(), 0.05);
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

TEST(PlaceByLandmarks, RefusesAHipTurnedOver) {
  const RigidTransform over{rotation_from_vector(Vec3(kPi, 0, 0)), Vec3(5, 6, 7)};
  EXPECT_NE(error_of(moved(toy::landmarks_of({}), over)).find("turned by 180 degrees"),
            std::string::npos);
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
