#include <coxa/segment/muscles.h>

#include <coxa/core/parallel.h>
#include <coxa/segment/evolve.h>
#include <coxa/segment/tissue_warp.h>
#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

TriMesh ball(const Vec3& centre, double radius) {
  TriMesh mesh = test::icosphere(3, radius);
  mesh.points.rowwise() += centre.transpose();
  return mesh;
}

double muscle_value(double d) { return 60.0 + 60.0 * (1.0 + std::tanh(d / 0.6)); }

/// Dark in each of the balls, bright outside.
PreparedImage image_of_balls(const std::vector<std::pair<Vec3, double>>& balls) {
  Volume v;
  v.size = {51, 51, 51};
  v.spacing = Vec3::Constant(2.0);
  v.origin = Vec3::Constant(-50.0);
  for (Index k = 0; k < 51; ++k) {
    for (Index j = 0; j < 51; ++j) {
      for (Index i = 0; i < 51; ++i) {
        double d = kInfinity;
        for (const auto& [centre, radius] : balls)
          d = std::min(d, (v.position(Vec3(i, j, k)) - centre).norm() - radius);
        v.values.push_back(static_cast<float>(muscle_value(d)));
      }
    }
  }
  PreparedImage image = prepare_image(v, false);
  image.contrast = "t1";
  return image;
}

TEST(Muscles, AreCarriedByAnyAffineMapOfTheBones) {
  Mat3 A;
  A << 1.1, 0.1, 0.0, -0.05, 0.9, 0.02, 0.0, 0.1, 1.05;
  const Vec3 t(5.0, -3.0, 8.0);
  std::vector<FoundBone> bones;
  for (const Vec3& centre : {Vec3(0, 0, 40), Vec3(10, 0, -40)}) {
    FoundBone bone{ball(centre, 15.0), ball(centre, 15.0)};
    bone.found.points = (bone.mean.points * A.transpose()).rowwise() + t.transpose();
    bones.push_back(bone);
  }
  const Points muscle = ball(Vec3(30, 5, 0), 12.0).points;
  const Points expected = (muscle * A.transpose()).rowwise() + t.transpose();
  EXPECT_LT((carried_by_bones(muscle, bones) - expected).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Muscles, BrightnessOfATissueHoldsWithAThirdOfOthers) {
  std::vector<double> values;
  Rng rng(3);
  for (int i = 0; i < 2000; ++i) values.push_back(100.0 + 5.0 * rng.normal());
  for (int i = 0; i < 900; ++i) values.push_back(220.0);
  const TissueBrightness found = tissue_brightness(values);
  EXPECT_NEAR(found.level, 102.0, 3.0);
  EXPECT_GT(found.likeness(100.0), 0.9);
  EXPECT_LT(found.likeness(220.0), 0.01);
}

TEST(Muscles, MoveTogetherToWhatLooksLikeMuscle) {
  const Vec3 off(7.0, -4.0, 3.0);
  const PreparedImage image = image_of_balls({{off, 24.0}});
  const TriMesh start = ball(Vec3::Zero(), 20.0);
  const auto moved_by = [&](double total_smoothing) {
    return moved_to_tissue({start}, {}, image, {start.points},
                           {.total_smoothing = total_smoothing});
  };
  const auto moved = moved_by(1.0);
  const auto away = [&](const Points& p) {
    const VecX r = (p.rowwise() - off.transpose()).rowwise().norm();
    return (r.array() - 24.0).abs().mean();
  };
  EXPECT_LT(away(moved.front()), 0.8 * away(start.points));  // the profiles do the rest
  EXPECT_LT(away(moved_by(0.3).front()), away(moved.front()));
  const auto serial = with_threads(1, [&] { return moved_by(1.0); });
  EXPECT_EQ(serial.front(), moved.front());
}

TEST(Muscles, OutsideTheViewStayWhereTheyAre) {
  const PreparedImage image = image_of_balls({{Vec3::Zero(), 20.0}});
  const TriMesh start = ball(Vec3(300, 0, 0), 20.0);
  EXPECT_EQ(moved_to_tissue({start}, {}, image, {start.points}, {}).front(), start.points);
}

TEST(Muscles, AreFoundBetweenBonesFoundAlready) {
  shape::Atlas atlas = toy::atlas();
  shape::StructureModel model = atlas.structures.front();
  model.muscle = true;
  model.profiles = {toy::profiles("t1", model.hierarchy.levels.back().n_vertices(), muscle_value)};
  std::vector<FoundBone> bones;
  for (const Vec3& centre : {Vec3(0, 0, 60), Vec3(0, 0, -60)})
    bones.push_back({ball(centre, 10.0), ball(centre, 10.0)});
  TriMesh truth = toy::egg_surface({1.5, -1.0}, 4);
  truth.points.rowwise() += Vec3(4.0, 2.0, 0.0).transpose();
  PreparedImage image =
      prepare_image(toy::image_of(truth, {.noise = 3.0, .value = muscle_value}), false);
  image.contrast = "t1_fluid";  // of the joint: the muscle's are those of t1
  const auto found = found_muscles({&model}, bones, {image}, {});
  EXPECT_LT(toy::mean_distance(surface_mesh(found.front()), truth), 0.4);
}

TEST(Muscles, InTheAtlasChangeNothingElse) {
  const shape::Atlas without = toy::atlas();
  shape::Atlas with = without;
  shape::StructureModel muscle = without.structures.front();
  muscle.name = "muscle";
  muscle.muscle = true;
  with.structures.push_back(muscle);
  const TriMesh truth = toy::egg_surface({1.0, 0.0}, 4);
  const Volume volume = toy::image_of(truth, {.spacing = Vec3::Constant(2.0)});
  SegmentOptions options;
  options.structures = {"egg"};
  options.iterations = 3;
  const auto marks = toy::landmarks_of({1.0, 0.0});
  const auto a = segment({volume}, without, Side::right, marks, options);
  const auto b = segment({volume}, with, Side::right, marks, options);
  EXPECT_EQ(a.surfaces.at("egg").mesh.points, b.surfaces.at("egg").mesh.points);
  EXPECT_EQ(b.surfaces.size(), 1u);
}

TEST(Front, PlacesFarFromEveryLandmarkCountLater) {
  const shape::Atlas atlas = toy::atlas();
  PreparedImage image = prepare_image(toy::image_of(toy::egg_surface({}, 4), {}), false);
  image.contrast = "t1";
  const Points mean = atlas.structures.front().hierarchy.levels.back().points;
  const VecX far = (mean.col(0).array() > 0.0).cast<double>();
  const auto confidence = [&](int iterations, double reach) {
    std::vector<Body> bodies(1);
    bodies[0].model = &atlas.structures.front();
    bodies[0].points = mean;
    if (reach > 0.0) bodies[0].reach = reach * far;
    const std::vector<Obstacles> none(1);
    const std::vector<TriMesh> no_host(1);
    const std::vector<PreparedImage> images{image};
    SegmentOptions options;
    options.iterations = iterations;
    options.tolerance = 0.0;
    update_bodies(bodies, {images, none, no_host},
                  {.range = 3.0, .first_reach = 60.0, .fit_only = true, .smooth = false}, options,
                  {});
    return bodies[0].match.confidence;
  };
  EXPECT_EQ(confidence(1, 0.0), confidence(1, 59.0));  // all near: as without landmarks
  const VecX first = confidence(1, 200.0), last = confidence(12, 200.0);
  EXPECT_EQ(first.dot(far), 0.0);
  EXPECT_GT(first.sum(), 10.0);
  EXPECT_GT(last.dot(far), 10.0);
}

}  // namespace
}  // namespace coxa::segment
