#include <coxa/segment/segment.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
namespace {

using toy::Egg;

const Egg kEgg{1.5, -1.0};

/// An egg that the model's modes cannot make: a smooth bulge of 1.5 mm on top.
TriMesh odd_egg() {
  TriMesh mesh = toy::egg_surface(kEgg, 4);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 u = mesh.points.row(v).transpose().normalized();
    const double bulge = 1.5 * std::exp(-4.0 * (u - Vec3(-0.6, 0.0, 0.8)).squaredNorm());
    mesh.points.row(v) += (bulge * u).transpose();
  }
  return mesh;
}

const TriMesh& truth() {
  static const TriMesh mesh = odd_egg();
  return mesh;
}
const Volume& image() {
  static const Volume volume = toy::image_of(truth(), {.noise = 3.0});
  return volume;
}
const shape::Atlas& atlas() {
  static const shape::Atlas a = toy::atlas();
  return a;
}

shape::Landmarks noisy_landmarks(double error) {
  shape::Landmarks marks = toy::landmarks_of(kEgg);
  Rng rng(11);
  for (auto& [name, p] : marks) p += error / std::sqrt(3.0) * rng.normal3();
  return marks;
}

SegmentOptions options() {
  SegmentOptions o;
  o.structures = {"egg"};
  return o;
}

SegmentResult run(const Volume& volume, const SegmentOptions& o = options(), double error = 3.0) {
  return segment({volume}, atlas(), Side::right, noisy_landmarks(error), o);
}

double error_of(const SegmentResult& result) {
  return toy::mean_distance(result.surfaces.at("egg").mesh, truth());
}

std::string text_of_failure(const std::vector<Volume>& volumes, const shape::Landmarks& marks,
                            const SegmentOptions& o) {
  try {
    segment(volumes, atlas(), Side::right, marks, o);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST(Segment, ConvergesToAKnownEggWithinAFractionOfAVoxel) {
  const SegmentResult result = run(image());
  EXPECT_LE(error_of(result), 0.15);
  EXPECT_EQ(result.contrasts.front(), "t1");
  EXPECT_GT(result.quality, 0.8);
  EXPECT_EQ(result.landmark_distances.size(), 8u);
  EXPECT_LT(result.landmark_distances.at("mark_2"), 8.0);
  EXPECT_LT(result.surfaces.at("egg").fields.at("completed").maxCoeff(), 0.5);
}

TEST(Segment, TellsTheContrastsApart) {
  const Volume bright = toy::image_of(truth(), {.noise = 3.0, .value = toy::bright_value});
  const SegmentResult result = run(bright);
  EXPECT_EQ(result.contrasts.front(), "bright");
  EXPECT_LE(error_of(result), 0.2);
}

TEST(Segment, LandmarksTenMillimetresOffChangeTheResultLittle) {
  const SegmentResult near = run(image(), options(), 0.0), far = run(image(), options(), 10.0);
  EXPECT_LE(toy::mean_distance(far.surfaces.at("egg").mesh, near.surfaces.at("egg").mesh), 0.1);
}

TEST(Segment, CompletesWhatLiesOutsideTheViewAndMarksIt) {
  const Volume part = toy::image_of(truth(), {.low = -10.0, .high = 42.0, .noise = 3.0});
  const SegmentResult result = run(part);
  const Surface& egg = result.surfaces.at("egg");
  const VecX& completed = egg.fields.at("completed");
  double inside = 0.0, outside = 0.0;
  int n_inside = 0, n_outside = 0;
  const TriangleTree tree(truth().points, truth().triangles);
  for (Index v = 0; v < egg.mesh.n_vertices(); ++v) {
    const Vec3 p = egg.mesh.points.row(v).transpose();
    const double d = std::sqrt(tree.nearest(p).squared_distance);
    if (p.z() > -8.0) inside += d, ++n_inside;
    if (p.z() < -8.0) outside += d, ++n_outside;
    if (p.z() > -7.0) {
      EXPECT_EQ(completed[v], 0.0) << p.transpose();
    }
    if (p.z() < -12.0) {
      EXPECT_EQ(completed[v], 1.0) << p.transpose();
    }
  }
  EXPECT_LE(inside / n_inside, 0.2);
  EXPECT_LE(outside / n_outside, 1.0);
  EXPECT_LT(result.structures.at("egg").in_view, 0.8);
}

TEST(Segment, SaysThatThereIsNoSignalInside) {
  Volume metal = image();
  for (Index k = 0; k < metal.size[2]; ++k)
    for (Index j = 0; j < metal.size[1]; ++j)
      for (Index i = 0; i < metal.size[0]; ++i) {
        if (metal.position(Vec3(i, j, k)).norm() < 16.0)
          metal.values[static_cast<std::size_t>(metal.offset(i, j, k))] = 2.0F;
      }
  const auto says_metal = [](const std::vector<std::string>& warnings) {
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) {
      return w.find("low confidence") != std::string::npos && w.find("metal") != std::string::npos;
    });
  };
  EXPECT_TRUE(says_metal(run(metal).warnings));
  EXPECT_FALSE(says_metal(run(image()).warnings));
}

TEST(Segment, RefusesLandmarksOfAnotherImage) {
  shape::Landmarks far = noisy_landmarks(0.0);
  for (auto& [name, p] : far) p += Vec3(0, 0, 300);
  EXPECT_NE(text_of_failure({image()}, far, options()).find("only 0 of 8 known landmarks lie in"),
            std::string::npos);
}

TEST(Segment, MirroredHipGivesTheMirroredResult) {
  const SegmentResult right = run(image());
  Volume flipped = image();
  flipped.origin.x() *= -1.0;
  flipped.direction.row(0) *= -1.0;
  shape::Landmarks marks = noisy_landmarks(3.0);
  for (auto& [name, p] : marks) p.x() *= -1.0;
  const SegmentResult left = segment({flipped}, atlas(), Side::left, marks, options());
  const TriMesh& a = right.surfaces.at("egg").mesh;
  const TriMesh& b = left.surfaces.at("egg").mesh;
  EXPECT_EQ(a.points.col(0), -b.points.col(0));
  EXPECT_EQ(a.points.col(2), b.points.col(2));
  EXPECT_EQ(a.triangles.col(1), b.triangles.col(2));
}

TEST(Segment, FollowsARigidMotionOfImageAndLandmarks) {
  const RigidTransform X = test::some_pose();
  Volume turned = image();
  turned.origin = X * turned.origin;
  turned.direction = X.R * turned.direction;
  shape::Landmarks marks = noisy_landmarks(3.0);
  for (auto& [name, p] : marks) p = X * p;
  const TriMesh here = run(image()).surfaces.at("egg").mesh;
  const TriMesh there =
      segment({turned}, atlas(), Side::right, marks, options()).surfaces.at("egg").mesh;
  // contact, profile and model know no axes; only rounding may grow over the iterations
  EXPECT_LE((transformed(here.points, X) - there.points).rowwise().norm().maxCoeff(), 0.01);
}

TEST(Segment, IsBitIdenticalForOneAndEightThreads) {
  const auto points = [] { return run(image()).surfaces.at("egg").mesh.points; };
  EXPECT_EQ(with_threads(1, points), with_threads(8, points));
}

TEST(Segment, FindsTheEggWithoutLandmarks) {
  const SegmentResult result = segment({image()}, atlas(), Side::right, {}, options());
  EXPECT_LE(error_of(result), 0.15);
  EXPECT_TRUE(result.landmark_distances.empty());
}

TEST(Segment, FindsTheEggInThickAndObliqueSlices) {
  const RigidTransform grid{rotation_from_vector(Vec3(0.2, 0.1, 0.0)), Vec3::Zero()};
  const Volume thick =
      toy::image_of(truth(), {.spacing = Vec3(1.0, 1.0, 3.0), .noise = 3.0, .grid = grid});
  EXPECT_LE(error_of(run(thick)), 0.35);
}

TEST(Segment, RefusesAnImageThatDoesNotShowTheHip) {
  const shape::Landmarks marks = toy::landmarks_of(kEgg);
  Volume elsewhere = image();
  elsewhere.origin += Vec3(300.0, 0.0, 0.0);
  EXPECT_NE(text_of_failure({elsewhere}, marks, options()), "");
  // another object where the hip should be: a smaller ball
  const Volume ball = toy::image_of(test::icosphere(3, 12.0), {.noise = 3.0, .core = 12.0});
  EXPECT_NE(text_of_failure({ball}, marks, options()).find("quality"), std::string::npos);
  Volume noise = image();
  Rng rng(3);
  for (float& value : noise.values) value = static_cast<float>(100.0 + 40.0 * rng.normal());
  EXPECT_NE(text_of_failure({noise}, marks, options()).find("quality"), std::string::npos);
}

TEST(Segment, RefusesAStartThatNothingSupportsOrThatHasARival) {
  Volume noise = image();
  Rng rng(3);
  for (float& value : noise.values) value = static_cast<float>(100.0 + 40.0 * rng.normal());
  EXPECT_NE(text_of_failure({noise}, {}, options()).find("not found without landmarks"),
            std::string::npos);
  // the same egg twice, side by side
  const Volume& one = image();
  Volume two = one;
  two.size[0] = 2 * one.size[0];
  two.values.resize(static_cast<std::size_t>(two.n_voxels()));
  for (Index k = 0; k < two.size[2]; ++k) {
    for (Index j = 0; j < two.size[1]; ++j) {
      for (Index i = 0; i < two.size[0]; ++i)
        two.values[static_cast<std::size_t>(two.offset(i, j, k))] =
            one.values[static_cast<std::size_t>(one.offset(i % one.size[0], j, k))];
    }
  }
  EXPECT_NE(text_of_failure({two}, {}, options()).find("another one by only"), std::string::npos);
}

TEST(Segment, RefusesNoImageAndTooFewLandmarks) {
  EXPECT_NE(text_of_failure({}, toy::landmarks_of(kEgg), options()), "");
  shape::Landmarks few = toy::landmarks_of(kEgg);
  while (few.size() > 3) few.erase(few.begin());
  EXPECT_NE(text_of_failure({image()}, few, options()).find("at least 6"), std::string::npos);
}

TEST(Segment, TwoImagesTogetherSeeMoreThanEither) {
  const Volume top = toy::image_of(truth(), {.low = 0.0, .high = 42.0, .noise = 3.0});
  const Volume bottom =
      toy::image_of(truth(), {.low = -42.0, .high = 0.0, .noise = 3.0, .value = toy::bright_value});
  SegmentOptions o = options();
  const SegmentResult both = segment({top, bottom}, atlas(), Side::right, noisy_landmarks(3.0), o);
  EXPECT_LE(error_of(both), 0.25);
  EXPECT_LT(error_of(both), error_of(run(top)));
  EXPECT_EQ(both.contrasts, (std::vector<std::string>{"t1", "bright"}));
}

}  // namespace coxa::segment
