#include <coxa/image/phantom.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>

namespace coxa {
namespace {

/// Sphere by subdividing an octahedron; radius such that the polyhedron has the sphere's volume.
TissueSurface sphere(const Vec3& centre, double radius, Tissue tissue) {
  std::vector<Vec3> points = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                              -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  std::vector<std::array<Index, 3>> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < 4; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (is_new)
        points.push_back((points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)])
                             .normalized());
      return entry->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  TissueSurface surface;
  surface.tissue = tissue;
  surface.points.resize(static_cast<Index>(points.size()), 3);
  for (Index i = 0; i < surface.points.rows(); ++i)
    surface.points.row(i) = points[static_cast<std::size_t>(i)];
  surface.triangles.resize(static_cast<Index>(triangles.size()), 3);
  double volume = 0.0;
  for (Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c)
      surface.triangles(t, c) = triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(c)];
    const auto corner = [&](int c) -> Vec3 { return surface.points.row(surface.triangles(t, c)); };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  const double scale = radius * std::cbrt(4.0 / 3.0 * kPi / volume);
  surface.points = (scale * surface.points).rowwise() + centre.transpose();
  return surface;
}

/// A small quiet image without shading, texture and noise.
PhantomOptions quiet() {
  PhantomOptions options;
  options.field_of_view = Vec3(32, 30, 28);
  options.centre = Vec3(5, -3, 100);
  options.voxel = Vec3(1.0, 1.0, 2.0);
  options.snr = kInfinity;
  options.bias = 0.0;
  options.texture = 0.0;
  options.body_semi_axes = Vec2(5.0, 5.0);  // air around the sphere
  options.subcutaneous_fat = 3.0;
  options.body_centre = Vec3(500, 500, 0);
  return options;
}
const Vec3 kCentre(5.3, -2.6, 100.4);

double sum(const Volume& image) {
  return std::accumulate(image.values.begin(), image.values.end(), 0.0);
}

TEST(Phantom, MuscleIsAHundredAndPartialVolumeKeepsTheVolume) {
  const Volume image = simulate_mri({sphere(kCentre, 10.0, Tissue::muscle)}, quiet());
  EXPECT_NEAR(sample(image, kCentre), 100.0, 1e-3);
  const double volume = sum(image) * image.spacing.prod() / 100.0;
  EXPECT_NEAR(volume, 4.0 / 3.0 * kPi * 1000.0, 0.002 * volume);
}
TEST(Phantom, PartialVolumePlacesTheCentreToAHundredthOfAMillimetre) {
  PhantomOptions options = quiet();
  options.oblique = Vec3(0.2, -0.1, 0.3);
  const Volume image = simulate_mri({sphere(kCentre, 10.0, Tissue::muscle)}, options);
  Vec3 moment = Vec3::Zero();
  for (Index k = 0; k < image.size[2]; ++k) {
    for (Index j = 0; j < image.size[1]; ++j) {
      for (Index i = 0; i < image.size[0]; ++i) {
        moment += image.values[static_cast<std::size_t>(image.offset(i, j, k))] *
                  image.position(Vec3(i, j, k));
      }
    }
  }
  EXPECT_LT((moment / sum(image) - kCentre).norm(), 0.01);
}
TEST(Phantom, ShellIsDarkBoneAroundBrightMarrow) {
  TissueSurface bone = sphere(kCentre, 12.0, Tissue::marrow);
  bone.shell = VecX::Constant(bone.points.rows(), 3.0);
  const Volume image = simulate_mri({bone}, quiet());
  EXPECT_GT(sample(image, kCentre), 200.0);
  EXPECT_LT(sample(image, kCentre + Vec3(10.5, 0, 0)), 15.0);
}
TEST(Phantom, LaterSurfacesCoverEarlierOnes) {
  const TissueSurface fat = sphere(kCentre, 10.0, Tissue::fat),
                      muscle = sphere(kCentre, 5.0, Tissue::muscle);
  EXPECT_NEAR(sample(simulate_mri({fat, muscle}, quiet()), kCentre), 100.0, 1e-3);
  EXPECT_GT(sample(simulate_mri({muscle, fat}, quiet()), kCentre), 300.0);
}
TEST(Phantom, JointSpaceIsFilledAsAsked) {
  const Vec3 half(0.0, 0.0, 5.35);  // two balls of cartilage 0.7 mm apart
  const std::vector<TissueSurface> balls = {sphere(kCentre - half, 5.0, Tissue::cartilage),
                                            sphere(kCentre + half, 5.0, Tissue::cartilage)};
  PhantomOptions options = quiet();
  options.voxel = Vec3::Constant(0.4);
  options.contrast = Contrast::t2;
  const double cartilage = sample(simulate_mri(balls, options), kCentre);
  options.joint_filling = Tissue::fluid;
  const double fluid = sample(simulate_mri(balls, options), kCentre);
  options.joint_reach = 0.0;
  const double open = sample(simulate_mri(balls, options), kCentre);
  EXPECT_GT(fluid, 2.0 * cartilage);
  EXPECT_LT(open, 0.7 * cartilage);
}
TEST(Phantom, NoiseIsRicianAtTheAskedRatio) {
  PhantomOptions options = quiet();
  options.snr = 20.0;
  const Volume image = simulate_mri({sphere(kCentre, 10.0, Tissue::muscle)}, options);
  double in_air = 0.0, mean = 0.0, square = 0.0;
  int n_air = 0, n_muscle = 0;
  for (Index k = 0; k < image.size[2]; ++k) {
    for (Index j = 0; j < image.size[1]; ++j) {
      for (Index i = 0; i < image.size[0]; ++i) {
        const double value = image.values[static_cast<std::size_t>(image.offset(i, j, k))];
        const double r = (image.position(Vec3(i, j, k)) - kCentre).norm();
        if (r > 13.0) {
          in_air += value;
          ++n_air;
        } else if (r < 7.5) {
          mean += value;
          square += value * value;
          ++n_muscle;
        }
      }
    }
  }
  mean /= n_muscle;
  EXPECT_NEAR(in_air / n_air, 5.0 * std::sqrt(kPi / 2.0), 0.1);  // mean of a Rayleigh variable
  EXPECT_NEAR(std::sqrt(square / n_muscle - mean * mean), 5.0, 0.35);
}
TEST(Phantom, EveryOptionHasItsEffect) {
  const std::vector<TissueSurface> ball = {sphere(kCentre, 10.0, Tissue::muscle)};
  PhantomOptions options = quiet();
  options.bias = 0.4;
  const Volume shaded = simulate_mri(ball, options);
  double low = 1e9, high = 0.0;
  for (int a = 0; a < 3; ++a) {
    for (const double side : {-8.0, 8.0}) {
      const double value = sample(shaded, kCentre + side * Vec3::Unit(a));
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  EXPECT_GT(high - low, 5.0);
  EXPECT_LT(high, 140.0);

  options = quiet();
  options.texture = 0.2;
  EXPECT_GT(std::abs(sample(simulate_mri(ball, options), kCentre) - 100.0), 0.5);

  options = quiet();
  options.fat_shift = 4.0;
  const Volume moved = simulate_mri({sphere(kCentre, 10.0, Tissue::fat)}, options);
  EXPECT_LT(sample(moved, kCentre - Vec3(8.5, 0, 0)),
            0.2 * sample(moved, kCentre + Vec3(8.5, 0, 0)));

  options = quiet();
  options.body_centre.reset();
  options.body_semi_axes = Vec2(12.0, 14.0);
  const Volume body = simulate_mri({sphere(kCentre, 2.0, Tissue::muscle)}, options);
  EXPECT_LT(sample(body, Vec3(20.0, 10.0, 100.0)), 5.0);  // outside the skin
  options.body_semi_axes = Vec2(60.0, 60.0);
  options.subcutaneous_fat = 100.0;
  EXPECT_GT(
      sample(simulate_mri({sphere(kCentre, 2.0, Tissue::muscle)}, options), Vec3(15, -3, 100)),
      300.0);
}
TEST(Phantom, ContrastsOrderTheTissuesAsScannersDo) {
  const auto total = [](Tissue tissue, Contrast contrast) {
    const Signal s = tissue_signal(tissue, contrast);
    return s.water + s.fat;
  };
  EXPECT_GT(total(Tissue::marrow, Contrast::t1), 2.0 * total(Tissue::cartilage, Contrast::t1));
  EXPECT_LT(total(Tissue::fluid, Contrast::t1), total(Tissue::cartilage, Contrast::t1));
  EXPECT_GT(total(Tissue::fluid, Contrast::t2), 3.0 * total(Tissue::cartilage, Contrast::t2));
  EXPECT_GT(total(Tissue::cartilage, Contrast::dess), total(Tissue::marrow, Contrast::dess));
  EXPECT_GT(total(Tissue::fluid, Contrast::dess), total(Tissue::cartilage, Contrast::dess));
  for (const Contrast contrast : {Contrast::t1, Contrast::t2, Contrast::pd, Contrast::dess}) {
    EXPECT_LT(total(Tissue::cortical_bone, contrast), 0.2 * total(Tissue::muscle, contrast));
    EXPECT_EQ(total(Tissue::air, contrast), 0.0);
  }
}
TEST(Phantom, IsBitIdenticalForAnyThreadCountAndDependsOnTheSeed) {
  PhantomOptions options = quiet();
  options.body_centre.reset();
  options.body_semi_axes = Vec2(40, 40);
  options.snr = 20.0;
  options.voxel = Vec3::Constant(2.0);
  const auto run = [&] {
    return simulate_mri({sphere(kCentre, 8.0, Tissue::marrow)}, options).values;
  };
  const auto one = with_threads(1, run);
  EXPECT_EQ(one, with_threads(8, run));
  options.seed = 2;
  EXPECT_NE(one, run());
}
TEST(Phantom, ReportsProgressAndStopsWhenCancelled) {
  const std::vector<TissueSurface> ball = {sphere(kCentre, 10.0, Tissue::muscle)};
  std::vector<double> shares;
  std::atomic<bool> cancelled = false;
  Monitor monitor;
  monitor.on_progress = [&](std::string_view, double share) { shares.push_back(share); };
  monitor.cancel_flag = &cancelled;
  simulate_mri(ball, quiet(), monitor);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
  cancelled = true;
  EXPECT_THROW(simulate_mri(ball, quiet(), monitor), Error);
}
TEST(Phantom, ShellGrowsDownTheShaft) {
  Points points(3, 3);
  points << 0, 0, 90, 0, 0, 15, 0, 0, -50;
  const VecX shell = shell_thicker_below(points, Vec3(0, 0, 100), 1.0, 5.0);
  EXPECT_EQ(shell[0], 1.0);
  EXPECT_NEAR(shell[1], 3.0, 1e-12);
  EXPECT_EQ(shell[2], 5.0);
}
TEST(Phantom, RefusesImpossibleOptions) {
  const std::vector<TissueSurface> ball = {sphere(kCentre, 10.0, Tissue::muscle)};
  EXPECT_THROW(simulate_mri({}, quiet()), Error);
  const auto refuses = [&](auto change) {
    PhantomOptions options = quiet();
    change(options);
    EXPECT_THROW(simulate_mri(ball, options), Error);
  };
  refuses([](PhantomOptions& o) { o.voxel[1] = 0.0; });
  refuses([](PhantomOptions& o) { o.field_of_view[0] = 0.1; });
  refuses([](PhantomOptions& o) { o.snr = 0.0; });
  refuses([](PhantomOptions& o) { o.bias = 1.0; });
  refuses([](PhantomOptions& o) { o.texture = -0.1; });
  refuses([](PhantomOptions& o) { o.joint_reach = -1.0; });
  refuses([](PhantomOptions& o) { o.body_semi_axes[0] = 0.0; });
}

}  // namespace
}  // namespace coxa
