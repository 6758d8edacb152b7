#pragma once

#include <coxa/core/types.h>

#include <optional>
#include <vector>

namespace coxa {

/// Nearest point on a triangle mesh.
struct NearestPoint {
  Index triangle = 0;
  Vec3 point = Vec3::Zero();        ///< mm
  Vec3 barycentric = Vec3::Zero();  ///< weights of the triangle's three vertices
  double squared_distance = 0.0;    ///< mm²
};

/// First triangle a ray meets.
struct RayHit {
  Index triangle = 0;
  double distance = 0.0;  ///< mm along the unit direction
  Vec3 barycentric = Vec3::Zero();
};

/// Axis-aligned bounding-volume tree over triangles; refits in place when the vertices move.
///
/// @note keeps its own copy of the vertices and triangles. Queries are const and may run in
/// parallel;
///       ties are broken by the lower triangle number, so answers do not depend on threads.
class TriangleTree {
 public:
  /// @param points V×3, mm   @param triangles T×3, at least one
  /// @throws Error bad_mesh if there is no triangle or an index is out of range
  TriangleTree(Points points, Triangles triangles);

  /// Nearest point within `max_distance`; nullopt when there is none that near.
  std::optional<NearestPoint> nearest_within(const Vec3& p, double max_distance) const;
  NearestPoint nearest(const Vec3& p) const;
  /// First hit at distance in [0, limit] along the unit vector `direction`, from either side.
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction, double limit) const;
  /// All triangles whose boxes meet the box [low, high], ascending.
  std::vector<Index> overlapping(const Vec3& low, const Vec3& high) const;
  /// Signed distance, negative inside; the surface must be closed and oriented outward
  /// (angle-weighted pseudo-normals, Baerentzen and Aanaes 2005).
  double signed_distance(const Vec3& p) const;
  /// The sign rule alone, for a nearest point already at hand: +1 outside, -1 inside.
  double sign_at(const Vec3& p, const NearestPoint& nearest) const;

  /// Moves the vertices (same number) and refits the boxes: cost O(T).
  void update_points(const Points& points);

  const Points& points() const { return points_; }
  const Triangles& triangles() const { return triangles_; }

 private:
  /// Box of a range of order_; an inner node's children stand side by side at child, child + 1.
  struct Node {
    Vec3 low, high;
    Index child = 0;           ///< 0 in a leaf
    Index begin = 0, end = 0;  ///< range in order_
  };
  void build();
  void refit();
  void copy_corners();

  Points points_;
  Triangles triangles_;
  std::vector<Node> nodes_;        ///< parents before children
  std::vector<Index> order_;       ///< triangle numbers, leaf by leaf
  std::vector<double> corners_;    ///< 9 per entry of order_: a, b, c
  std::vector<Index> ring_begin_;  ///< V+1, ranges in ring_
  std::vector<Index> ring_;        ///< triangles around each vertex, ascending
};

}  // namespace coxa
