#include "preparation.h"

namespace coxa::segment {
namespace {

/// mm, over which unknown deformations are alike.
constexpr double kLongLength = 60.0, kShortLength = 25.0;

}  // namespace

Preparation prepared(const shape::StructureModel& model, double long_deviation,
                     double short_deviation) {
  const SimplexMesh& mesh = model.hierarchy.levels.back();
  Preparation preparation;
  for (const shape::ProfileSet& set : model.profiles)
    preparation.kinds[set.contrast] = profile_kinds(set, mesh.neighbours);
  preparation.smooth =
      joined(smooth_modes(mesh.points, {.deviation = long_deviation, .length = kLongLength}),
             smooth_modes(mesh.points, {.deviation = short_deviation, .length = kShortLength}));
  return preparation;
}

}  // namespace coxa::segment
