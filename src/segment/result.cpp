#include "result.h"

#include <coxa/mesh/mirrored.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// mm. A residual of this much, after the last resolution, means that image and shape disagree.
constexpr double kResidualScale = 1.5;
/// mm. Bones that the examples do not describe leave the fitted model by 1 to 2 mm on average; what
/// leaves it by this much is something else.
constexpr double kDeviationScale = 4.0;
/// How much of that a smooth deformation of the model counts: it is likelier than one that is not.
constexpr double kSmoothShare = 0.4;
/// Share of a structure that must be in view for full confidence in the whole.
constexpr double kFullView = 0.2;

}  // namespace

StructureQuality quality_of(const Body& body) {
  StructureQuality quality;
  double weight = 0.0;
  for (Index v = 0; v < body.match.seen.size(); ++v) {
    quality.in_view += body.match.seen[v];
    quality.correlation += body.match.seen[v] * body.match.here[v];
    quality.residual += body.match.seen[v] * std::abs(body.match.shift[v]);
    weight += body.match.seen[v];
  }
  if (weight > 0.0) {
    quality.correlation /= weight;
    quality.residual /= weight;
  }
  const double deviation =
      (body.points - body.fit.points).rowwise().norm().mean() + kSmoothShare * body.fit.off_model;
  quality.in_view /= static_cast<double>(std::max<Eigen::Index>(1, body.match.seen.size()));
  quality.confidence = std::clamp(quality.correlation, 0.0, 1.0) *
                       std::exp(-quality.residual / kResidualScale) *
                       std::exp(-std::pow(deviation / kDeviationScale, 2)) *
                       std::min(1.0, quality.in_view / kFullView);
  return quality;
}

Surface surface_of(const Body& body) {
  Surface surface;
  surface.mesh = surface_mesh(body);
  const Index n = surface.mesh.n_vertices();
  VecX confidence = VecX::Zero(n), completed = VecX::Zero(n), count = VecX::Zero(n);
  for (Index t = 0; t < surface.mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index v = surface.mesh.triangles(t, k);
      confidence[v] += body.match.confidence[t];
      completed[v] += 1.0 - body.match.seen[t];
      count[v] += 1.0;
    }
  }
  confidence.array() /= count.array().max(1.0);
  completed.array() /= count.array().max(1.0);
  surface.fields["confidence"] = confidence;
  surface.fields["completed"] = (completed.array() > 0.5).cast<double>();
  return surface;
}

Surface mirrored(Surface surface) {
  surface.mesh = coxa::mirrored(std::move(surface.mesh));
  return surface;
}

}  // namespace coxa::segment
