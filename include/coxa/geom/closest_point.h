#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// Nearest point of one triangle, with the barycentric weights of its corners (exactly 0 off the
/// interior).
struct TrianglePoint {
  Vec3 point = Vec3::Zero();
  Vec3 barycentric = Vec3::Zero();
  double squared_distance = 0.0;  ///< mm²
};

/// Nearest point to p on triangle abc; a triangle without area counts as its three edges.
///
/// Source: Ericson 2005, Real-Time Collision Detection, 5.1.5 (Voronoi regions).
TrianglePoint closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Parameter in [0, 1] of the point of segment ab nearest to p; 0 where a and b coincide.
double closest_parameter_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace coxa
