#pragma once

#include <coxa/core/types.h>

namespace coxa {

/// Exact sign of det(b-a, c-a, d-a): +1 where abc is seen counter-clockwise from d, 0 where the
/// four points lie in one plane, whatever the rounding.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Exact sign of the area of abc in the plane that leaves out coordinate `axis` (0, 1, 2), cyclic
/// order.
int orientation_in_plane(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// Whether two closed triangles with area share a point; touching counts. Exact.
bool triangles_meet(const Vec3& a0, const Vec3& a1, const Vec3& a2, const Vec3& b0, const Vec3& b1,
                    const Vec3& b2);

/// Whether the closed segment pq and the closed triangle abc share a point. Exact.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                            const Vec3& c);

}  // namespace coxa
