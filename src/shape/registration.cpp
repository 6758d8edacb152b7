#include <coxa/shape/registration.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>

#include "elastic_surface.h"
#include "surface_pulls.h"

namespace coxa::shape {
namespace {

// the last projection moves a vertex no farther than this, mm
constexpr double kProjectionReach = 2.0;
// after the last stage every vertex is laid on the target this many times, evened in between
constexpr int kProjectionRounds = 3;
constexpr double kEveningLength = 1.0;  // mm

void check(const TrustedSurface& moving, const TrustedSurface& target,
           const RegistrationOptions& options) {
  if (moving.mesh.empty() || target.mesh.empty())
    fail(ErrorCode::bad_mesh, "registration needs two surfaces with triangles");
  require(options.similarity_iterations >= 0, "similarity_iterations must not be negative, got ",
          options.similarity_iterations);
  require(options.iterations >= 1, "registration needs at least one iteration, got ",
          options.iterations);
  require(options.largest_distance > 0.0, "largest_distance must be positive, got ",
          options.largest_distance);
  require(-1.0 <= options.normal_limit && options.normal_limit < 1.0,
          "normal_limit must be in [-1, 1), got ", options.normal_limit);
  for (const double length : options.lengths)
    require(length > 0.0, "lengths must be positive, got ", length);
}

void update_similarity(TrustedSurface& moving, const PullTarget& target,
                       const RegistrationOptions& options) {
  for (int i = 0; i < options.similarity_iterations; ++i) {
    const Pulls pulls = target.pulls_on(moving, options);
    const Points goal = moving.mesh.points + pulls.displacement;
    const Similarity fit = fit_similarity(moving.mesh.points, goal, pulls.weight);
    moving.mesh.points = transformed(fit.scale * moving.mesh.points, fit.X);
  }
}

/// Lays the vertices on the target; those far from it stay with their neighbours.
void project(TrustedSurface& moving, const PullTarget& target, const ElasticSurface& elastic,
             const RegistrationOptions& options) {
  RegistrationOptions near = options;
  near.largest_distance = kProjectionReach;
  for (int round = 0; round < kProjectionRounds; ++round) {
    const Pulls pulls = target.forward_pulls(moving, near);
    Points& points = moving.mesh.points;
    points = elastic.relaxed(points, points + pulls.displacement, pulls.weight, kEveningLength);
  }
}

}  // namespace

Points register_similarity(const TrustedSurface& moving, const TrustedSurface& target,
                           const RegistrationOptions& options) {
  check(moving, target, options);
  TrustedSurface current = moving;
  update_similarity(current, PullTarget(target), options);
  return current.mesh.points;
}

Points register_surface(const TrustedSurface& moving, const TrustedSurface& target,
                        const RegistrationOptions& options, const Monitor& monitor) {
  return refine_registration(moving, register_similarity(moving, target, options), target, options,
                             monitor);
}

Points refine_registration(const TrustedSurface& moving, const Points& start,
                           const TrustedSurface& target, const RegistrationOptions& options,
                           const Monitor& monitor) {
  check(moving, target, options);
  const PullTarget pull_target(target);
  const ElasticSurface elastic(moving.mesh);
  TrustedSurface current = moving;
  current.mesh.points = start;
  for (const double length : options.lengths) {
    for (int i = 0; i < options.iterations; ++i) {
      monitor.check_cancelled();
      const Pulls pulls = pull_target.pulls_on(current, options);
      Points& points = current.mesh.points;
      points =
          elastic.relaxed(points, points + pulls.displacement, pulls.weight.cwiseMin(1.0), length);
    }
  }
  project(current, pull_target, elastic, options);
  return current.mesh.points;
}

}  // namespace coxa::shape
