#include <coxa/geom/closest_point.h>

#include <algorithm>

namespace coxa {
namespace {

TrianglePoint at_vertex(const Vec3& p, const Vec3& vertex, int corner) {
  return {vertex, Vec3::Unit(corner), (p - vertex).squaredNorm()};
}

// point (1 - s) v_from + s v_to of the edge between two corners
TrianglePoint on_edge(const Vec3& p, const Vec3& v_from, const Vec3& v_to, int from, int to,
                      double s) {
  if (s <= 0.0) return at_vertex(p, v_from, from);
  if (s >= 1.0) return at_vertex(p, v_to, to);
  TrianglePoint result;
  result.point = v_from + s * (v_to - v_from);
  result.barycentric[from] = 1.0 - s;
  result.barycentric[to] = s;
  result.squared_distance = (p - result.point).squaredNorm();
  return result;
}

TrianglePoint closest_point_on_edges(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3* corners[3] = {&a, &b, &c};
  TrianglePoint best;
  best.squared_distance = kInfinity;
  for (int from = 0; from < 3; ++from) {
    const int to = (from + 1) % 3;
    const double s = closest_parameter_on_segment(p, *corners[from], *corners[to]);
    const TrianglePoint candidate = on_edge(p, *corners[from], *corners[to], from, to, s);
    if (candidate.squared_distance < best.squared_distance) best = candidate;
  }
  return best;
}

}  // namespace

double closest_parameter_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double squared_length = ab.squaredNorm();
  if (!(squared_length > 0.0)) return 0.0;
  return std::clamp(ab.dot(p - a) / squared_length, 0.0, 1.0);
}

TrianglePoint closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                        const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return at_vertex(p, a, 0);

  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return at_vertex(p, b, 1);

  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return at_vertex(p, c, 2);

  // va, vb, vc: areas (times a common factor) opposite the corners; one that vanishes beside a
  // nearly flat triangle says nothing, so such triangles go by their edges
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  const double sum = va + vb + vc;
  const double flat = 1e-20 * ab.squaredNorm() * ac.squaredNorm();
  if (!(sum > flat)) return closest_point_on_edges(p, a, b, c);

  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return on_edge(p, a, b, 0, 1, d1 / (d1 - d3));
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return on_edge(p, a, c, 0, 2, d2 / (d2 - d6));
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return on_edge(p, b, c, 1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));

  TrianglePoint result;
  const double v = vb / sum, w = vc / sum;
  result.point = a + v * ab + w * ac;
  result.barycentric = Vec3(1.0 - v - w, v, w);
  result.squared_distance = (p - result.point).squaredNorm();
  return result;
}

}  // namespace coxa
