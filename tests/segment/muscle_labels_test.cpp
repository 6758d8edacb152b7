#include <coxa/segment/muscle_labels.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/core/rng.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/validate.h>
#include <coxa/segment/distance_map.h>
#include <coxa/segment/label_parts.h>
#include <coxa/segment/random_walker.h>
#include <coxa/segment/share_tissue.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "support/shapes.h"

namespace coxa::segment {
namespace {

TriMesh ball(const Vec3& centre, double radius) {
  TriMesh mesh = test::icosphere(3, radius);
  mesh.points.rowwise() += centre.transpose();
  return mesh;
}

double mean_radius_off(const TriMesh& mesh, const Vec3& centre, double radius) {
  const VecX r = (mesh.points.rowwise() - centre.transpose()).rowwise().norm();
  return (r.array() - radius).abs().mean();
}

Volume grid_of(const std::array<Index, 3>& size, const Vec3& spacing) {
  Volume grid;
  grid.size = size;
  grid.spacing = spacing;
  grid.origin = -0.5 * spacing.cwiseProduct(Vec3(size[0] - 1.0, size[1] - 1.0, size[2] - 1.0));
  return grid;
}

/// Muscle (60) in each ball, fat (200) about them, bone marrow included; some noise.
PreparedImage image_of_balls(const std::vector<std::pair<Vec3, double>>& balls) {
  Volume v = grid_of({61, 41, 27}, Vec3(1.5, 1.5, 2.0));
  Rng rng(5);
  for (Index k = 0; k < v.size[2]; ++k) {
    for (Index j = 0; j < v.size[1]; ++j) {
      for (Index i = 0; i < v.size[0]; ++i) {
        double d = kInfinity;
        for (const auto& [centre, radius] : balls)
          d = std::min(d, (v.position(Vec3(i, j, k)) - centre).norm() - radius);
        v.values.push_back(
            static_cast<float>(130.0 + 70.0 * std::tanh(d / 0.7) + 4.0 * rng.normal()));
      }
    }
  }
  return prepare_image(v, false);
}

TEST(DistanceMap, IsThatOfAllVoxelsTriedOneByOne) {
  const Volume grid = grid_of({9, 7, 6}, Vec3(1.0, 0.8, 3.0));
  Mask mask(static_cast<std::size_t>(grid.n_voxels()), 0);
  Rng rng(11);
  for (int n = 0; n < 12; ++n)
    mask[static_cast<std::size_t>(rng.uniform() * static_cast<double>(mask.size()))] = 1;
  const auto place = [&](std::int64_t v) { return grid.position(Vec3(v % 9, v / 9 % 7, v / 63)); };
  const std::vector<float> found = distances_to(mask, grid);
  for (std::int64_t v = 0; v < grid.n_voxels(); ++v) {
    double nearest = kInfinity;
    for (std::int64_t w = 0; w < grid.n_voxels(); ++w)
      if (mask[static_cast<std::size_t>(w)] != 0)
        nearest = std::min(nearest, (place(v) - place(w)).norm());
    EXPECT_NEAR(found[static_cast<std::size_t>(v)], nearest, 1e-5);
  }
  const std::vector<float> depth = depths_in(mask, grid);
  for (std::size_t v = 0; v < depth.size(); ++v) EXPECT_EQ(depth[v] > 0.0F, mask[v] == 1);
  EXPECT_EQ(distances_to(Mask(mask.size(), 0), grid).front(), kInfinity);
  EXPECT_THROW(distances_to(Mask(3, 1), grid), Error);
}

/// A row of voxels with one weak link.
WalkGraph row_of_voxels(Index n, Index weak) {
  WalkGraph graph;
  for (Index v = 0; v < n; ++v) {
    graph.next.push_back({v + 1 < n ? v + 1 : -1, -1, -1});
    graph.weight.push_back({v == weak ? 0.001F : 1.0F, 0.0F, 0.0F});
  }
  return graph;
}

WalkPrior prior_at(Index n, Index voxel) {
  WalkPrior prior;
  for (Index v = 0; v < n; ++v) {
    prior.voxels.push_back(v);
    prior.share.push_back(v == voxel ? 1.0F : 0.0F);
  }
  return prior;
}

TEST(RandomWalker, PutsTheBorderAtTheWeakestLink) {
  constexpr Index kN = 20;
  const std::vector<WalkPrior> priors{prior_at(kN, 0), prior_at(kN, kN - 1)};
  for (const Index weak : {4, 9, 13}) {
    const std::vector<int> label = likeliest_labels(row_of_voxels(kN, weak), priors);
    for (Index v = 0; v < kN; ++v)
      EXPECT_EQ(label[static_cast<std::size_t>(v)], v <= weak ? 0 : 1) << weak;
  }
}

TEST(RandomWalker, AgreesWithTheEquationsSolvedAsAWhole) {
  constexpr Index kN = 30;
  Rng rng(2);
  WalkGraph graph;
  MatX system = MatX::Zero(kN, kN);
  const auto link = [&](Index v, Index w, double weight) {
    system(v, v) += weight, system(w, w) += weight;
    system(v, w) -= weight, system(w, v) -= weight;
  };
  for (Index v = 0; v < kN; ++v) {
    graph.next.push_back({v + 1 < kN ? v + 1 : -1, v + 6 < kN ? v + 6 : -1, -1});
    graph.weight.push_back(
        {static_cast<float>(0.1 + rng.uniform()), static_cast<float>(0.1 + rng.uniform()), 0.0F});
    for (std::size_t a = 0; a < 2; ++a)
      if (graph.next.back()[a] >= 0) link(v, graph.next.back()[a], graph.weight.back()[a]);
  }
  WalkOptions options;
  options.tolerance = 1e-12;
  std::vector<WalkPrior> priors(3);
  MatX pull = MatX::Zero(kN, 3);
  for (Index k = 0; k < 3; ++k) {
    for (Index v = 0; v < kN; ++v) {
      const auto share = static_cast<float>(rng.uniform() < 0.1 ? 1.0 : 0.0);
      priors[static_cast<std::size_t>(k)].voxels.push_back(v);
      priors[static_cast<std::size_t>(k)].share.push_back(share);
      pull(v, k) = options.prior_weight * share;
    }
  }
  system.diagonal() += pull.rowwise().sum();
  system.diagonal().array() += options.prior_weight * options.other_share;
  const MatX exact = system.partialPivLu().solve(pull);
  const std::vector<int> label = likeliest_labels(graph, priors, options);
  for (Index v = 0; v < kN; ++v) {
    Index best = 0;
    exact.row(v).maxCoeff(&best);
    EXPECT_EQ(label[static_cast<std::size_t>(v)], best);
  }
}

TEST(RandomWalker, LeavesWhatNothingIsLinkedWithToNone) {
  WalkGraph graph = row_of_voxels(10, 5);
  graph.next[5] = {-1, -1, -1};
  const std::vector<int> label = likeliest_labels(graph, {prior_at(10, 0)});
  EXPECT_EQ(label[5], 0);
  EXPECT_EQ(label[6], -1);
  EXPECT_THROW(likeliest_labels(graph, {}, {.prior_weight = 0.0}), Error);
}

TEST(MuscleLabels, MeetWhereTheImageShowsFatAndTakeWhatTheirPlaceMisses) {
  const Vec3 a(-16.0, 0.0, 0.0), b(14.5, 0.0, 0.0);
  const PreparedImage image = image_of_balls({{a, 15.0}, {b, 14.0}});
  // both lie 5 mm to one side, the second is too small
  const std::vector<TriMesh> bodies{ball(a + Vec3(5.0, 0.0, 0.0), 15.0),
                                    ball(b + Vec3(5.0, 0.0, 0.0), 9.0)};
  const auto found = [&] { return muscle_labels(bodies, {}, image); };
  const BodyLabels labels = found();
  ASSERT_EQ(labels.bodies.size(), 2u);
  EXPECT_GT(labels.bodies[1].shown(), 2.0);
  EXPECT_GT(labels.bodies[0].overlap(), 0.6);
  for (int k = 0; k < 2; ++k) {
    const Vec3& centre = k == 0 ? a : b;
    const TriMesh mesh = label_surface(labels, k, bodies[static_cast<std::size_t>(k)], 1.0);
    EXPECT_TRUE(validate(mesh).valid()) << validate(mesh).text();
    EXPECT_LT(mean_radius_off(mesh, centre, k == 0 ? 15.0 : 14.0), 0.4);
  }
  EXPECT_EQ(with_threads(1, found).label, with_threads(8, found).label);
}

TEST(MuscleLabels, AreNoneInAnImageWithoutContrast) {
  PreparedImage image = image_of_balls({{Vec3::Zero(), 15.0}});
  Rng rng(1);
  for (float& value : image.volume.values) value = static_cast<float>(60.0 + 4.0 * rng.normal());
  EXPECT_TRUE(muscle_labels({ball(Vec3::Zero(), 14.0)}, {}, image).bodies.empty());
  EXPECT_THROW(muscle_labels({}, {}, image, {.softness = 0.0}), Error);
}

TEST(LabelParts, SmallOnesAreDroppedAndBeyondTheViewTheBodyGoesOn) {
  BodyLabels labels{grid_of({41, 41, 41}, Vec3::Ones()), {}, {}};
  const Vec3 centre(12.0, 0.0, 0.0);
  for (std::int64_t v = 0; v < labels.grid.n_voxels(); ++v) {
    const Vec3 p = labels.grid.position(Vec3(v % 41, v / 41 % 41, v / 1681));
    const bool in = (p - centre).norm() < 12.0 || (p + Vec3(15.0, 0.0, 0.0)).norm() < 2.0;
    labels.label.push_back(in ? 0 : -1);
  }
  drop_small_parts(labels, 1, 0.05);
  const TriMesh mesh = label_surface(labels, 0, ball(centre, 12.0), 1.0);
  EXPECT_TRUE(validate(mesh).valid()) << validate(mesh).text();
  EXPECT_LT(mean_radius_off(mesh, centre, 12.0), 0.3);
  EXPECT_GT(mesh.points.col(0).maxCoeff(), 23.5);
  EXPECT_GT(mesh.points.col(0).minCoeff(), -1.0);
  EXPECT_EQ(label_surface(labels, 1, ball(centre, 12.0), 1.0).n_vertices(), 0);
}

TEST(ShareTissue, GivesSurfacesThatDoNotMeetAndNamesWhatTheImageDoesNotShow) {
  const Vec3 a(-16.0, 0.0, 0.0), b(14.5, 0.0, 0.0);
  const PreparedImage image = image_of_balls({{a, 15.0}, {b, 14.0}});
  std::vector<Surface> muscles(3);
  muscles[0].mesh = ball(a + Vec3(4.0, 0.0, 0.0), 15.0);
  muscles[1].mesh = ball(b + Vec3(4.0, 0.0, 0.0), 13.0);
  muscles[2].mesh = ball(Vec3(0.0, 22.0, 15.0), 6.0);
  for (Surface& muscle : muscles)
    muscle.fields["confidence"] = VecX::Constant(muscle.mesh.n_vertices(), 0.7);
  const auto texts = update_to_tissue(
      {{"first", &muscles[0], 0.8}, {"second", &muscles[1], 0.7}, {"lost", &muscles[2], 0.9}}, {},
      {}, image);
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_EQ(texts.front(), "low confidence: the image shows no lost where the model has it");
  EXPECT_LT(mean_radius_off(muscles[0].mesh, a, 15.0), 0.5);
  EXPECT_LT(mean_radius_off(muscles[1].mesh, b, 14.0), 0.5);
  EXPECT_EQ(muscles[2].mesh.points, ball(Vec3(0.0, 22.0, 15.0), 6.0).points);
  EXPECT_NEAR(muscles[1].fields.at("confidence").mean(), 0.7, 1e-9);
  EXPECT_EQ(muscles[1].fields.at("confidence").size(), muscles[1].mesh.n_vertices());
}

}  // namespace
}  // namespace coxa::segment
