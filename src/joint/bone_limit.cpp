#include "bone_limit.h"

#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/vertex_normals.h>

#include <cmath>

namespace coxa::joint {
namespace {

constexpr double kCoverReach = 2.0;            // mm from the cartilage: covered bone
constexpr double kFoveaAngle = radians(60.0);  // from the cartilage's middle
constexpr double kFoveaHeight = 1.5;           // mm outside the head's sphere at most
constexpr double kLookAround = 5.0;            // mm: clearances beyond are not measured

}  // namespace

std::vector<bool> limit_vertices(const JointModel& model) {
  const TetMesh& cartilage = model.femoral_cartilage;
  const TriMesh bone_side{cartilage.points, facets_with(cartilage, FacetTag::bone_side)};
  const TriangleTree covered(cartilage.points, cartilage.facets);
  Points centroids(bone_side.n_triangles(), 3);
  for (Index f = 0; f < bone_side.n_triangles(); ++f) {
    centroids.row(f) = bone_side.points(bone_side.triangles.row(f), Eigen::all).colwise().mean();
  }
  const Sphere head = fit_sphere(centroids, triangle_areas(bone_side));
  // the bone side faces the head's centre: the cartilage's middle is opposite its mean normal
  const Vec3 middle =
      -(triangle_normals(bone_side).transpose() * triangle_areas(bone_side)).normalized();

  std::vector<char> counts(static_cast<std::size_t>(model.femur.n_vertices()));
  parallel_for(model.femur.n_vertices(), [&](Index v) {
    const Vec3 p = model.femur.points.row(v), arm = p - head.centre;
    const bool fovea = arm.norm() < head.radius + kFoveaHeight &&
                       arm.normalized().dot(middle) > std::cos(kFoveaAngle);
    counts[static_cast<std::size_t>(v)] = !fovea && !covered.nearest_within(p, kCoverReach);
  });
  return {counts.begin(), counts.end()};
}

BoneLimit::BoneLimit(const JointModel& model, const TriMesh& fixed) {
  if (fixed.empty() || model.femur.empty()) return;
  pair_.emplace(fixed, model.femur, limit_vertices(model));
}

double BoneLimit::clearance(const RigidTransform& X_II) const {
  const auto found = nearest(X_II, kLookAround);
  return found ? found->distance : kNaN;
}

std::optional<collide::Clearance> BoneLimit::nearest(const RigidTransform& X_II,
                                                     double reach) const {
  if (!pair_) return std::nullopt;
  const collide::Clearance found = pair_->clearance(X_II, reach);
  return std::isfinite(found.distance) ? std::optional(found) : std::nullopt;
}

collide::FirstContact BoneLimit::first_touch(
    const std::function<RigidTransform(double)>& pose_at) const {
  const auto contact = collide::first_contact(*pair_, pose_at, 1);
  return contact ? *contact : collide::FirstContact{1.0, {}};
}

}  // namespace coxa::joint
