#include <coxa/segment/layer_search.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/segment/seat.h>
#include <coxa/shape/shape_modes.h>

#include <algorithm>

namespace coxa::segment {
namespace {

constexpr Index kMostModes = 8;
/// Standard deviations by which a mode is varied, in turn.
constexpr double kSteps[] = {1.0, 1.0, 0.5, 0.5, 0.25};
constexpr double kFarthest = 2.5;  // standard deviations
/// What a mode at one standard deviation must bring in mean correlation.
constexpr double kPrior = 0.002;

}  // namespace

Points laid_on(const Points& shape, Index n_bone_side, const TriMesh& mean, const TriMesh& now,
               double gap) {
  const TriangleTree tree(mean.points, mean.triangles);
  Points laid(shape.rows(), 3);
  parallel_for(n_bone_side, [&](Index v) {
    const NearestPoint near = tree.nearest(shape.row(v).transpose());
    const TriangleFrame from = triangle_frame(mean, near.triangle, near.barycentric);
    const TriangleFrame to = triangle_frame(now, near.triangle, near.barycentric);
    const Vec3 seat = to.origin + gap * to.axes.col(2);
    const Vec3 offset = (shape.row(v + n_bone_side) - shape.row(v)).transpose();
    laid.row(v) = seat.transpose();
    laid.row(v + n_bone_side) = (seat + to.axes * (from.axes.transpose() * offset)).transpose();
  });
  return laid;
}

Points layer_by_modes(const Body& layer, const TriMesh& mean, const TriMesh& now,
                      std::span<const PreparedImage> images, const Resolution& resolution,
                      const SegmentOptions& options) {
  const shape::StructureModel& model = *layer.model;
  const Points& mean_points = model.hierarchy.levels.back().points;
  Body trial = layer;
  const auto value_of = [&](const VecX& b) {
    trial.points = laid_on(shape::shape_from(mean_points, model.shape, b), model.n_bone_side, mean,
                           now, options.minimum_gap);
    const ProfileMatch match = match_body(trial, images, resolution, options.gradient_weight);
    return match.here.mean() - kPrior * b.squaredNorm();
  };
  VecX best = VecX::Zero(std::min<Eigen::Index>(kMostModes, model.shape.deviations.size()));
  double value = value_of(best);
  for (const double step : kSteps) {
    for (Eigen::Index m = 0; m < best.size(); ++m) {
      for (const double change : {step, -step}) {
        VecX b = best;
        b[m] = std::clamp(b[m] + change, -kFarthest, kFarthest);
        const double other = value_of(b);
        if (other <= value) continue;
        value = other;
        best = b;
        break;
      }
    }
  }
  return laid_on(shape::shape_from(mean_points, model.shape, best), model.n_bone_side, mean, now,
                 options.minimum_gap);
}

}  // namespace coxa::segment
