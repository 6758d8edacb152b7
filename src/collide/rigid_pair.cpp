#include <coxa/collide/rigid_pair.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <algorithm>
#include <cmath>

namespace coxa::collide {
namespace {

// overlaps are looked for to this depth, mm: deeper than any step of a movement makes them
constexpr double kDeepest = 30.0;

/// The nearer of two; the first where equal, so that the order of vertices decides ties.
Clearance nearer(Clearance a, const Clearance& b) { return b.distance < a.distance ? b : a; }

Clearance swapped(const Clearance& c) { return {c.distance, c.moving_point, c.fixed_point}; }

/// Least signed distance of the points to the surface of `tree`, all in the frame of `tree`; of
/// points and nearest triangles that count.
template <class PointCounts, class TriangleCounts>
Clearance least_distance(const Points& points, const PointCounts& point_counts,
                         const TriangleTree& tree, const TriangleCounts& triangle_counts,
                         double limit) {
  return parallel_reduce(
      points.rows(), Clearance{},
      [&](Index v) {
        if (!point_counts(v)) return Clearance{};
        const Vec3 p = points.row(v);
        const auto nearest = tree.nearest_within(p, limit);
        if (!nearest || !triangle_counts(nearest->triangle)) return Clearance{};
        const double distance = std::sqrt(nearest->squared_distance) * tree.sign_at(p, *nearest);
        return Clearance{distance, nearest->point, p};
      },
      nearer);
}

}  // namespace

RigidPair::RigidPair(const TriMesh& fixed, const TriMesh& moving, std::vector<bool> counted)
    : fixed_(fixed.points, fixed.triangles),
      moving_(moving.points, moving.triangles),
      counted_(std::move(counted)) {
  if (counted_.empty()) counted_.assign(static_cast<std::size_t>(moving.n_vertices()), true);
  require(counted_.size() == static_cast<std::size_t>(moving.n_vertices()), "contact mask has ",
          counted_.size(), " entries for ", moving.n_vertices(), " vertices");
}

Clearance RigidPair::clearance(const RigidTransform& X, double limit) const {
  require(limit > 0.0, "clearance limit must be positive, got ", limit, " mm");
  const auto every = [](Index) { return true; };
  const auto vertex_counts = [&](Index v) { return bool{counted_[static_cast<std::size_t>(v)]}; };
  const Clearance of_moving =
      least_distance(transformed(moving_.points(), X), vertex_counts, fixed_, every, limit);

  // the fixed vertices, seen from the moving surface; a triangle counts when all its corners do
  const auto triangle_counts = [&](Index triangle) {
    const auto corners = moving_.triangles().row(triangle);
    return std::all_of(corners.begin(), corners.end(), vertex_counts);
  };
  Clearance of_fixed = least_distance(transformed(fixed_.points(), X.inverse()), every, moving_,
                                      triangle_counts, limit);
  of_fixed.fixed_point = X * of_fixed.fixed_point;
  of_fixed.moving_point = X * of_fixed.moving_point;
  return nearer(of_moving, swapped(of_fixed));
}

double penetration(const TriMesh& a, const TriMesh& b) {
  const double distance = RigidPair(a, b).clearance(RigidTransform{}, kDeepest).distance;
  return std::max(0.0, -distance);
}

std::optional<FirstContact> first_contact(const RigidPair& pair,
                                          const std::function<RigidTransform(double)>& pose_at,
                                          Index last, double threshold) {
  const double limit = std::max(2.0, 2.0 * std::abs(threshold));
  const auto touches = [&](double parameter) -> std::optional<FirstContact> {
    const Clearance clearance = pair.clearance(pose_at(parameter), limit);
    if (clearance.distance > threshold) return std::nullopt;
    return FirstContact{parameter, clearance};
  };
  for (Index step = 0; step <= last; ++step) {
    auto hit = touches(step);
    if (!hit) continue;
    double apart = step - 1.0, together = step;
    while (step > 0 && together - apart > 1e-3) {
      const double middle = 0.5 * (apart + together);
      if (const auto earlier = touches(middle)) {
        hit = earlier;
        together = middle;
      } else {
        apart = middle;
      }
    }
    return hit;
  }
  return std::nullopt;
}

}  // namespace coxa::collide
