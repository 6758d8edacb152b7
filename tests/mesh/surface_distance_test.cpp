#include <coxa/mesh/surface_distance.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/measures.h>
#include <gtest/gtest.h>
#include "support/shapes.h"

namespace coxa {

TEST(SurfaceDistance, BetweenConcentricSpheresIsTheGap) {
  const TriMesh inner = test::icosphere(5, 10.0), outer = test::icosphere(5, 10.5);
  const SurfaceDistance d = surface_distance(outer, inner);
  EXPECT_NEAR(d.assd, 0.5, 2e-3);
  EXPECT_NEAR(d.rms, 0.5, 2e-3);
  EXPECT_NEAR(d.hd95, 0.5, 4e-3);
  EXPECT_NEAR(d.hd, 0.5, 0.01);
  EXPECT_NEAR(d.bias, 0.5, 2e-3);
  EXPECT_NEAR(surface_distance(inner, outer).bias, -0.5, 2e-3);
  EXPECT_LE(surface_distance(inner, inner).hd, 1e-12);
}
TEST(SurfaceDistance, JudgesOnlyWhatLiesWithin) {
  TriMesh bent = test::icosphere(4);
  for (Index v = 0; v < bent.n_vertices(); ++v)
    if (bent.points(v, 2) > 0) bent.points(v, 2) += 1.0;
  const SurfaceDistance d = surface_distance(bent, test::icosphere(4),
                                             {.within = [](const Vec3& p) { return p[2] < -2.0; }});
  EXPECT_LE(d.hd, 1e-9);
  EXPECT_THROW(surface_distance(bent, bent, {.within = [](const Vec3&) { return false; }}), Error);
}
TEST(SurfaceDistance, MoreSamplesAndAnotherSeedChangeLittle) {
  const TriMesh a = test::icosphere(4), b = test::moved(a, {Mat3::Identity(), Vec3(0.5, 0, 0)});
  const double assd = surface_distance(a, b).assd;
  EXPECT_NE(surface_distance(a, b, {.seed = 2}).assd, assd);
  EXPECT_NE(surface_distance(a, b, {.samples_per_mm2 = 8.0}).assd, assd);
  EXPECT_NEAR(surface_distance(a, b, {.seed = 2}).assd, assd, 0.02);
  EXPECT_NEAR(surface_distance(a, b, {.max_samples = 500}).assd, assd, 0.05);
  EXPECT_NEAR(assd, 0.25, 0.02);  // mean of |0.5 cos| over the sphere
}
TEST(SurfaceDistance, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [] { return surface_distance(test::torus(), test::icosphere(3)).assd; };
  EXPECT_EQ(with_threads(1, run), with_threads(8, run));
}
TEST(SurfaceDistance, RejectsEmptySurfacesAndBadOptions) {
  EXPECT_THROW(surface_distance({}, test::box()), Error);
  EXPECT_THROW(surface_distance(test::box(), test::box(), {.samples_per_mm2 = 0.0}), Error);
  EXPECT_THROW(surface_distance(test::box(), test::box(), {.max_samples = 0}), Error);
  EXPECT_THROW(sample_surface({}, 3, 1), Error);
}
TEST(SampleSurface, SpreadsPointsByArea) {
  const Points points = sample_surface(test::box(Vec3(0, 0, 0), Vec3(1, 1, 8)), 20000, 3);
  const double ends =
      (points.col(2).array() < 1e-12 || points.col(2).array() > 8 - 1e-12).cast<double>().mean();
  EXPECT_NEAR(ends, 2.0 / 34.0, 0.006);
}
TEST(VolumeOverlap, OfShiftedBoxesIsTheClosedForm) {
  const TriMesh a = test::box(Vec3(0, 0, 0), Vec3(8, 8, 8)),
                b = test::box(Vec3(2, 0, 0), Vec3(10, 8, 8));
  EXPECT_NEAR(volume_overlap(a, b, 0.23), 0.75, 0.02);
  EXPECT_EQ(volume_overlap(a, a, 0.5), 1.0);
  EXPECT_EQ(volume_overlap(a, test::box(Vec3(20, 0, 0), Vec3(21, 8, 8)), 0.5), 0.0);
  EXPECT_THROW(volume_overlap(a, b, 0.0), Error);
}

}  // namespace coxa
