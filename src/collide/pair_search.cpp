#include "pair_search.h"

#include <coxa/geom/closest_point.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coxa::collide {
namespace {

// a projection that misses the open border by less than this share of an edge still counts as on it
constexpr double kBorderShare = 1e-3;
// a line along the smooth normal may pass a triangle by this share of its edges: beyond,
// interpolated normals mean nothing and the plane runs away from the surface
constexpr double kFarthestMiss = 0.5;
// distances below this have no direction of their own, mm
constexpr double kTouching = 1e-9;
// edges crossed on the way to the nearest triangle before all are searched
constexpr int kLongestWalk = 4;

Vec3 corner(const OtherSurface& other, Index triangle, int k) {
  return other.tree.points().row(other.tree.triangles()(triangle, k)).transpose();
}

Vec3 face_normal(const OtherSurface& other, Index triangle) {
  const Vec3 a = corner(other, triangle, 0);
  return (corner(other, triangle, 1) - a).cross(corner(other, triangle, 2) - a).normalized();
}

Vec3 smooth_normal(const OtherSurface& other, Index triangle, const Vec3& barycentric) {
  Vec3 normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    normal +=
        barycentric[k] * other.vertex_normals.row(other.tree.triangles()(triangle, k)).transpose();
  }
  return normal.normalized();
}

/// Whether the nearest point lies on the open border of the surface.
bool on_border(const OtherSurface& other, const NearestPoint& nearest) {
  for (int k = 0; k < 3; ++k) {
    const Index vertex = other.tree.triangles()(nearest.triangle, k);
    if (nearest.barycentric[k] == 1.0 && other.boundary_vertex[static_cast<std::size_t>(vertex)]) {
      return true;
    }
    // edge k joins corners k and k+1: the third weight is zero on it
    if (nearest.barycentric[(k + 2) % 3] == 0.0 && other.neighbours(nearest.triangle, k) < 0) {
      return true;
    }
  }
  return false;
}

/// Whether the sample lies beyond the open border: its nearest point is there and off to the side.
bool beyond_border(const OtherSurface& other, const Vec3& point, const NearestPoint& nearest) {
  if (!on_border(other, nearest)) return false;
  const Vec3 normal = smooth_normal(other, nearest.triangle, nearest.barycentric);
  const Vec3 offset = point - nearest.point;
  double edge = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 side =
        corner(other, nearest.triangle, (k + 1) % 3) - corner(other, nearest.triangle, k);
    edge = std::max(edge, side.norm());
  }
  return (offset - offset.dot(normal) * normal).norm() > kBorderShare * edge;
}

/// Barycentric weights of the point where the line through `point` along `direction` meets the
/// triangle's plane; nullopt where it hardly does.
std::optional<Vec3> line_hit(const OtherSurface& other, Index triangle, const Vec3& point,
                             const Vec3& direction) {
  const Vec3 a = corner(other, triangle, 0);
  const Vec3 u = corner(other, triangle, 1) - a, v = corner(other, triangle, 2) - a;
  const Vec3 area = u.cross(v);
  const double slope = area.normalized().dot(direction);
  if (!(std::abs(slope) > 0.3)) return std::nullopt;
  const Vec3 hit = point - direction * ((point - a).dot(area) / direction.dot(area)) - a;
  const double squared = area.squaredNorm();
  const double second = hit.cross(v).dot(area) / squared, third = u.cross(hit).dot(area) / squared;
  return Vec3(1.0 - second - third, second, third);
}

/// Where the line along the smooth normal arrives; at a crease, where none does, the nearest point.
FacedPoint along_smooth_normal(const OtherSurface& other, const Vec3& point,
                               const NearestPoint& nearest) {
  FacedPoint faced{nearest.triangle, nearest.barycentric, Vec3::Zero(), 1.0};
  // fixed point of "the normal where the line along the normal arrives"; contracts as gap over
  // radius
  for (int iteration = 0; iteration < 3; ++iteration) {
    faced.normal = smooth_normal(other, faced.triangle, faced.barycentric);
    const auto hit = line_hit(other, faced.triangle, point, faced.normal);
    if (!hit || hit->minCoeff() < -kFarthestMiss) {
      faced.barycentric = nearest.barycentric;
      faced.normal = smooth_normal(other, nearest.triangle, nearest.barycentric);
      return faced;
    }
    faced.barycentric = *hit;
  }
  return faced;
}

NearestPoint nearest_on(const OtherSurface& other, Index triangle, const Vec3& point) {
  const TrianglePoint on = closest_point_on_triangle(
      point, corner(other, triangle, 0), corner(other, triangle, 1), corner(other, triangle, 2));
  return {triangle, on.point, on.barycentric, on.squared_distance};
}

/// From triangle to triangle across the edge that is nearest, up to one that is nearest inside.
std::optional<NearestPoint> walk(const OtherSurface& other, const Vec3& point, NearestPoint at) {
  for (int step = 0; step < kLongestWalk; ++step) {
    int across = -1, edges = 0;
    for (int k = 0; k < 3; ++k) {
      if (at.barycentric[k] != 0.0) continue;
      across = (k + 1) % 3;  // the edge opposite to corner k
      ++edges;
    }
    if (edges == 0) return at;
    const Index next = edges == 1 ? other.neighbours(at.triangle, across) : -1;
    if (next < 0) break;
    const double before = at.squared_distance;
    at = nearest_on(other, next, point);
    if (!(at.squared_distance < before)) break;
  }
  return std::nullopt;
}

/// The nearest point of the other surface, or by a walk from the triangle that was nearest before.
std::optional<NearestPoint> find_nearest(const OtherSurface& other, const Vec3& point, Index before,
                                         SearchHint hint, const ContactOptions& options) {
  if (before < 0) return other.tree.nearest_within(point, options.search_distance);
  const NearestPoint first = nearest_on(other, before, point);
  if (hint == SearchHint::followed) {
    const auto found = walk(other, point, first);
    if (found && found->squared_distance <= options.search_distance * options.search_distance)
      return found;
  }
  // no farther than that triangle; a little more, because the search rounds
  const double bound = std::sqrt(first.squared_distance) * (1.0 + 1e-9) + kTouching;
  return other.tree.nearest_within(point, std::min(options.search_distance, bound));
}

}  // namespace

SampleSearch find_faced_point(const OtherSurface& other, const Vec3& point, const Vec3& normal,
                              Index before, SearchHint hint, const ContactOptions& options) {
  const auto nearest = find_nearest(other, point, before, hint, options);
  if (!nearest) return {};
  const double distance = std::sqrt(nearest->squared_distance);
  const auto not_faced = [&]() -> SampleSearch {
    return {std::nullopt, nearest, other.tree.sign_at(point, *nearest) > 0.0};
  };
  if (beyond_border(other, point, *nearest)) return not_faced();

  FacedPoint faced{nearest->triangle, nearest->barycentric, Vec3::Zero(), 1.0};
  if (options.normal == ContactNormal::smooth) {
    faced = along_smooth_normal(other, point, *nearest);
  } else {
    faced.normal =
        distance > kTouching
            ? Vec3(other.tree.sign_at(point, *nearest) / distance * (point - nearest->point))
            : face_normal(other, nearest->triangle);
  }
  const double facing = -normal.dot(faced.normal);
  if (options.facing > -1.0 && facing < options.facing) return not_faced();
  if (facing < options.facing_fully) {
    faced.share = (facing - options.facing) / (options.facing_fully - options.facing);
    if (!(faced.share > 0.0)) return not_faced();
  }
  return {faced, nearest, true};
}

Points edge_bulges(const TriMesh& mesh) {
  const Points normals = vertex_normals(mesh);
  Points bulges(mesh.n_triangles(), 3);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index a = mesh.triangles(t, k), b = mesh.triangles(t, (k + 1) % 3);
      const Vec3 edge = (mesh.points.row(b) - mesh.points.row(a)).transpose();
      bulges(t, k) = 0.5 * (edge.dot(normals.row(b)) - edge.dot(normals.row(a)));
    }
  }
  return bulges;
}

double bulge(const Points& bulges, Index triangle, const Vec3& barycentric) {
  if (bulges.rows() == 0) return 0.0;
  double height = 0.0;
  for (int k = 0; k < 3; ++k) {
    height += bulges(triangle, k) * barycentric[k] * barycentric[(k + 1) % 3];
  }
  return height;
}

}  // namespace coxa::collide
