#include <coxa/segment/force_field.h>

#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>

#include <algorithm>

namespace coxa::segment {
namespace {

/// Weight of a vertex without confidence in means: it follows its surroundings, but is never a
/// division by 0.
constexpr double kLeastWeight = 1e-6;
/// Vertices with confidence below which twelve affine numbers are not worth fitting.
constexpr Index kLeastAffineVertices = 12;

bool enough_for_affine(const VecX& confidence) {
  return (confidence.array() > 0.0).count() >= kLeastAffineVertices;
}

}  // namespace

Points smoothed_field(const Points& field, const VecX& confidence, const Triangles& neighbours,
                      int passes) {
  Points values = field;
  VecX weights = confidence;
  for (int pass = 0; pass < passes; ++pass) {
    const Points previous = values;
    const VecX previous_weights = weights;
    parallel_for(previous.rows(), [&](Index v) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (const Index u : {v, neighbours(v, 0), neighbours(v, 1), neighbours(v, 2)}) {
        const double w = kLeastWeight + previous_weights[u];
        sum += w * previous.row(u).transpose();
        total += w;
      }
      values.row(v) = sum.transpose() / total;
      weights[v] = 0.25 * total;
    });
  }
  return values;
}

Points restricted(const Points& fine, const VecX& weight, const LevelMap& map, Index n_coarse) {
  Points sum = Points::Zero(n_coarse, 3);
  VecX total = VecX::Zero(n_coarse);
  for (Index v = 0; v < fine.rows(); ++v) {
    for (int k = 0; k < 3; ++k) {
      const double w = std::max(0.0, map.weights(v, k)) * (kLeastWeight + weight[v]);
      sum.row(map.parents(v, k)) += w * fine.row(v);
      total[map.parents(v, k)] += w;
    }
  }
  for (Index c = 0; c < n_coarse; ++c) {
    if (total[c] > 0.0) sum.row(c) /= total[c];
  }
  return sum;
}

Points prolonged(const Points& coarse, const LevelMap& map) {
  Points fine(map.parents.rows(), 3);
  for (Index v = 0; v < fine.rows(); ++v) {
    fine.row(v) = map.weights(v, 0) * coarse.row(map.parents(v, 0)) +
                  map.weights(v, 1) * coarse.row(map.parents(v, 1)) +
                  map.weights(v, 2) * coarse.row(map.parents(v, 2));
  }
  return fine;
}

Points coarse_part(const Points& field, const VecX& confidence, const LevelMap& map,
                   Index n_coarse) {
  return prolonged(restricted(field, confidence, map, n_coarse), map);
}

Points combined_levels(const Points& field, const VecX& confidence, std::span<const LevelMap> maps,
                       double share) {
  if (maps.empty()) return field;
  const LevelMap& map = maps.back();
  const Index n_coarse = map.parents.size() == 0 ? 0 : map.parents.maxCoeff() + 1;
  const Points coarse = restricted(field, confidence, map, n_coarse);
  Points weight(field.rows(), 3);
  weight.setZero();
  weight.col(0) = confidence;
  const VecX coarse_confidence = restricted(weight, VecX::Ones(field.rows()), map, n_coarse).col(0);
  const Points low = combined_levels(coarse, coarse_confidence, maps.first(maps.size() - 1), share);
  return share * field + (1.0 - share) * prolonged(low, map);
}

Points regularised_by_affine(const Points& positions, const Points& field, const VecX& confidence,
                             double k) {
  if (k >= 1.0) return field;
  if (!enough_for_affine(confidence)) return k * field;
  const AffineTransform affine = fit_affine(positions, positions + field, confidence);
  Points regular(field.rows(), 3);
  for (Index v = 0; v < field.rows(); ++v) {
    const Vec3 p = positions.row(v).transpose();
    regular.row(v) = (affine * p - p).transpose();
  }
  return k * field + (1.0 - k) * regular;
}

Points rigid_part(const Points& positions, const Points& field, const VecX& confidence) {
  if (!enough_for_affine(confidence)) return Points::Zero(field.rows(), 3);
  const RigidTransform X = fit_rigid(positions, positions + field, confidence);
  return transformed(positions, X) - positions;
}

}  // namespace coxa::segment
