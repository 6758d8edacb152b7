#include <coxa/segment/segment.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include "toy.h"

namespace coxa::segment {
using toy::Egg;

TEST(Segment, ConvergesToAKnownEggWithinAFractionOfAVoxel) {
  const Egg egg{1.5, -1.0};
  const TriMesh truth = toy::egg_surface(egg, 4);
  const Volume image = toy::image_of(truth, {});
  SegmentOptions options;
  options.structures = {"egg"};
  const SegmentResult result =
      segment({image}, toy::atlas(), Side::right, toy::landmarks_of(egg), options);
  const Surface& surface = result.surfaces.at("egg");
  printf("dist %g quality %g corr %g res %g %s\n", toy::mean_distance(surface.mesh, truth),
         result.quality, result.structures.at("egg").correlation,
         result.structures.at("egg").residual, result.contrasts[0].c_str());
  EXPECT_LE(toy::mean_distance(surface.mesh, truth), 0.2);
}

}  // namespace coxa::segment
