#include <coxa/segment/cortex_search.h>

#include <coxa/core/parallel.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace coxa::segment {
namespace {

// A ball of bone in fat beside a muscle: cortex 2 mm thick, the muscle from x = 26 mm outwards.
constexpr double kRadius = 20.0, kMuscle = 26.0;

PreparedImage simulated_image() {
  PreparedImage image;
  Volume& volume = image.volume;
  volume.spacing = Vec3::Ones();
  volume.size = {80, 80, 80};
  volume.origin = Vec3::Constant(-39.5);
  volume.values.resize(static_cast<std::size_t>(volume.n_voxels()));
  for (Index k = 0; k < 80; ++k) {
    for (Index j = 0; j < 80; ++j) {
      for (Index i = 0; i < 80; ++i) {
        const Vec3 p = volume.position(Vec3(i, j, k));
        const double r = p.norm();
        const bool cortex = r > kRadius - 2.0 && r < kRadius;
        volume.values[static_cast<std::size_t>(volume.offset(i, j, k))] = cortex ? 15.0F
                                                                          : p.x() > kMuscle
                                                                              ? 70.0F
                                                                              : 190.0F;
      }
    }
  }
  return image;
}

shape::StructureModel ball() {
  shape::StructureModel model;
  model.name = "ball";
  model.hierarchy.levels.push_back(make_simplex_mesh(test::icosphere(4, kRadius)));
  return model;
}

/// Vertices towards +x lie on the muscle's border, the others on the bone's.
Points half_lost(const shape::StructureModel& model) {
  Points points = model.hierarchy.levels.back().points;
  for (Index v = 0; v < points.rows(); ++v) {
    const Vec3 u = points.row(v).normalized();
    if (u.x() > 0.8) points.row(v) = kMuscle / u.x() * u.transpose();
  }
  return points;
}

Points drawn(const shape::StructureModel& model, const Points& start) {
  Body body;
  body.model = &model;
  body.points = start;
  return drawn_to_cortex(body, std::vector<PreparedImage>{simulated_image()});
}

}  // namespace

TEST(CortexSearch, BringsBackWhatHasSettledOnAMusclesBorder) {
  const shape::StructureModel model = ball();
  const Points start = half_lost(model), found = drawn(model, start);
  for (Index v = 0; v < start.rows(); ++v) {
    const double x = start.row(v).normalized().x();
    if (x > 0.9) {
      EXPECT_NEAR(found.row(v).norm(), kRadius, 3.0) << x;
    }
    if (x < 0.5) {
      EXPECT_NEAR(found.row(v).norm(), kRadius, 0.5) << x;
    }
  }
}

TEST(CortexSearch, LeavesABoneInPlace) {
  const shape::StructureModel model = ball();
  const Points start = model.hierarchy.levels.back().points;
  EXPECT_EQ(drawn(model, start), start);
}

TEST(CortexSearch, LeavesABoneInAnImageOfOneBrightness) {
  const shape::StructureModel model = ball();
  Body body;
  body.model = &model;
  body.points = model.hierarchy.levels.back().points;
  PreparedImage image = simulated_image();
  std::fill(image.volume.values.begin(), image.volume.values.end(), 50.0F);
  EXPECT_EQ(drawn_to_cortex(body, std::vector<PreparedImage>{image}), body.points);
}

}  // namespace coxa::segment
