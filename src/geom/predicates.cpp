#include <coxa/geom/predicates.h>

#include <Eigen/Geometry>
#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cmath>

namespace coxa {
namespace {

using Exact = boost::multiprecision::cpp_rational;

int sign_of(const Exact& value) { return value.sign(); }
int sign_of(double value) { return (value > 0.0) - (value < 0.0); }

template <class T>
T determinant(const T& ax, const T& ay, const T& az, const T& bx, const T& by, const T& bz,
              const T& cx, const T& cy, const T& cz) {
  return T(ax * T(T(by * cz) - T(bz * cy))) + T(ay * T(T(bz * cx) - T(bx * cz))) +
         T(az * T(T(bx * cy) - T(by * cx)));
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto difference = [&](const Vec3& p, int k) { return Exact(Exact(p[k]) - Exact(a[k])); };
  return sign_of(determinant<Exact>(difference(b, 0), difference(b, 1), difference(b, 2),
                                    difference(c, 0), difference(c, 1), difference(c, 2),
                                    difference(d, 0), difference(d, 1), difference(d, 2)));
}

// an axis along which the triangle has area when looked at
int axis_to_drop(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 normal = (b - a).cross(c - a).cwiseAbs();
  int axis = 0;
  normal.maxCoeff(&axis);
  for (int k = 0; k < 3; ++k)
    if (orientation_in_plane(a, b, c, (axis + k) % 3) != 0) return (axis + k) % 3;
  return axis;
}

// r on segment pq, all three known to lie in one line
bool between(const Vec3& p, const Vec3& q, const Vec3& r) {
  return (p.cwiseMin(q).array() <= r.array()).all() && (r.array() <= p.cwiseMax(q).array()).all();
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, int axis) {
  const int pa = orientation_in_plane(p, q, a, axis), pb = orientation_in_plane(p, q, b, axis);
  const int ap = orientation_in_plane(a, b, p, axis), aq = orientation_in_plane(a, b, q, axis);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && between(p, q, a)) || (pb == 0 && between(p, q, b)) ||
         (ap == 0 && between(a, b, p)) || (aq == 0 && between(a, b, q));
}

bool in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int ab = orientation_in_plane(a, b, p, axis), bc = orientation_in_plane(b, c, p, axis),
            ca = orientation_in_plane(c, a, p, axis);
  return std::min({ab, bc, ca}) >= 0 || std::max({ab, bc, ca}) <= 0;
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double value = determinant<double>(u[0], u[1], u[2], v[0], v[1], v[2], w[0], w[1], w[2]);
  // Shewchuk 1997: rounding cannot have changed the sign above this share of the permanent
  const Vec3 m = u.cwiseAbs(), n = v.cwiseAbs(), o = w.cwiseAbs();
  const double permanent = m[0] * (n[1] * o[2] + n[2] * o[1]) + m[1] * (n[2] * o[0] + n[0] * o[2]) +
                           m[2] * (n[0] * o[1] + n[1] * o[0]);
  if (std::abs(value) > 8e-16 * permanent) return sign_of(value);
  return exact_orientation(a, b, c, d);
}

int orientation_in_plane(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]);
  if (std::abs(left - right) > 4e-16 * (std::abs(left) + std::abs(right)))
    return sign_of(left - right);
  const Exact exact_left = (Exact(b[x]) - Exact(a[x])) * (Exact(c[y]) - Exact(a[y]));
  const Exact exact_right = (Exact(b[y]) - Exact(a[y])) * (Exact(c[x]) - Exact(a[x]));
  return sign_of(Exact(exact_left - exact_right));
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                            const Vec3& c) {
  const int side_p = orientation(a, b, c, p), side_q = orientation(a, b, c, q);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const int axis = axis_to_drop(a, b, c);
    return in_triangle(p, a, b, c, axis) || segments_meet(p, q, a, b, axis) ||
           segments_meet(p, q, b, c, axis) || segments_meet(p, q, c, a, axis);
  }
  const int ab = orientation(p, q, a, b), bc = orientation(p, q, b, c),
            ca = orientation(p, q, c, a);
  return std::min({ab, bc, ca}) >= 0 || std::max({ab, bc, ca}) <= 0;
}

bool triangles_meet(const Vec3& a0, const Vec3& a1, const Vec3& a2, const Vec3& b0, const Vec3& b1,
                    const Vec3& b2) {
  return segment_meets_triangle(a0, a1, b0, b1, b2) || segment_meets_triangle(a1, a2, b0, b1, b2) ||
         segment_meets_triangle(a2, a0, b0, b1, b2) || segment_meets_triangle(b0, b1, a0, a1, a2) ||
         segment_meets_triangle(b1, b2, a0, a1, a2) || segment_meets_triangle(b2, b0, a0, a1, a2);
}

}  // namespace coxa
