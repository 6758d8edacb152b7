#include <coxa/geom/triangle_tree.h>

#include <coxa/core/error.h>
#include <coxa/geom/closest_point.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa {
namespace {

constexpr std::size_t kStackSize = 80;  // deeper than the deepest tree the builder makes
// boxes are compared with this relative slack, so that rounding cannot hide a tie
constexpr double kSlack = 1.0 - 1e-12;

double squared_distance_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  const double x = std::max(std::max(low[0] - p[0], p[0] - high[0]), 0.0);
  const double y = std::max(std::max(low[1] - p[1], p[1] - high[1]), 0.0);
  const double z = std::max(std::max(low[2] - p[2], p[2] - high[2]), 0.0);
  return (x * x + y * y + z * z) * kSlack;
}

struct Pending {
  Index node;
  double key;  // squared distance, or distance along a ray, at which the box starts
};

// Ray in the sheared frame of Woop, Benthin and Wald 2013: edges shared by two triangles leave no
// crack.
struct ShearedRay {
  Vec3 origin, direction, inverse;
  std::array<int, 3> axis{};
  double shear_x = 0.0, shear_y = 0.0, scale = 0.0;

  ShearedRay(const Vec3& o, const Vec3& d) : origin(o), direction(d), inverse(d.cwiseInverse()) {
    int z = 0;
    d.cwiseAbs().maxCoeff(&z);
    axis = {(z + 1) % 3, (z + 2) % 3, z};
    shear_x = d[axis[0]] / d[z];
    shear_y = d[axis[1]] / d[z];
    scale = 1.0 / d[z];
  }

  // distance at which the ray enters the box, or infinity
  double entry(const Vec3& low, const Vec3& high, double limit) const {
    double from = 0.0, to = limit;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0.0) {
        if (origin[k] < low[k] || origin[k] > high[k]) return kInfinity;
        continue;
      }
      const double t0 = (low[k] - origin[k]) * inverse[k], t1 = (high[k] - origin[k]) * inverse[k];
      from = std::max(from, std::min(t0, t1) - 1e-12 * std::abs(t0));
      to = std::min(to, std::max(t0, t1) + 1e-12 * std::abs(t1));
    }
    return from <= to ? from : kInfinity;
  }

  std::optional<RayHit> hit(const double* corners, Index triangle) const {
    double x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 v = Eigen::Map<const Vec3>(corners + 3 * k) - origin;
      z[k] = v[axis[2]];
      x[k] = v[axis[0]] - shear_x * z[k];
      y[k] = v[axis[1]] - shear_y * z[k];
    }
    const Vec3 areas(x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2],
                     x[1] * y[0] - y[1] * x[0]);
    if (areas.minCoeff() < 0.0 && areas.maxCoeff() > 0.0) return std::nullopt;
    const double sum = areas.sum();
    if (sum == 0.0) return std::nullopt;
    const Vec3 barycentric = areas / sum;
    return RayHit{triangle,
                  scale * (barycentric[0] * z[0] + barycentric[1] * z[1] + barycentric[2] * z[2]),
                  barycentric};
  }
};

Vec3 area_vector(const Points& points, const Triangles& triangles, Index t) {
  const Vec3 a = points.row(triangles(t, 0)), b = points.row(triangles(t, 1)),
             c = points.row(triangles(t, 2));
  return (b - a).cross(c - a);
}

int corner_of(const Triangles& triangles, Index t, Index vertex) {
  return triangles(t, 0) == vertex ? 0 : triangles(t, 1) == vertex ? 1 : 2;
}

bool contains(const Triangles& triangles, Index t, Index vertex) {
  return triangles(t, 0) == vertex || triangles(t, 1) == vertex || triangles(t, 2) == vertex;
}

double corner_angle(const Points& points, const Triangles& triangles, Index t, int corner) {
  const Vec3 a = points.row(triangles(t, corner));
  const Vec3 u = points.row(triangles(t, (corner + 1) % 3)).transpose() - a;
  const Vec3 v = points.row(triangles(t, (corner + 2) % 3)).transpose() - a;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

std::optional<NearestPoint> TriangleTree::nearest_within(const Vec3& p, double max_distance) const {
  double best = max_distance * max_distance;
  if (!(max_distance >= 0.0)) return std::nullopt;
  Index triangle = -1;
  TrianglePoint found;
  std::array<Pending, kStackSize> stack;
  std::size_t depth = 0;
  const Node* nodes = nodes_.data();
  stack[depth++] = {0, squared_distance_to_box(p, nodes[0].low, nodes[0].high)};
  while (depth > 0) {
    Pending current = stack[--depth];
    if (!(current.key <= best)) continue;
    // go down to a leaf, nearer child first
    while (nodes[current.node].child != 0) {
      const Index child = nodes[current.node].child;
      Pending near{child, squared_distance_to_box(p, nodes[child].low, nodes[child].high)};
      Pending far{child + 1,
                  squared_distance_to_box(p, nodes[child + 1].low, nodes[child + 1].high)};
      if (far.key < near.key) std::swap(near, far);
      if (far.key <= best) stack[depth++] = far;
      current = near;
      if (!(current.key <= best)) break;
    }
    if (!(current.key <= best) || nodes[current.node].child != 0) continue;
    for (Index i = nodes[current.node].begin; i < nodes[current.node].end; ++i) {
      const double* corner = &corners_[9 * static_cast<std::size_t>(i)];
      const TrianglePoint candidate = closest_point_on_triangle(p, Eigen::Map<const Vec3>(corner),
                                                                Eigen::Map<const Vec3>(corner + 3),
                                                                Eigen::Map<const Vec3>(corner + 6));
      const Index number = order_[static_cast<std::size_t>(i)];
      if (candidate.squared_distance < best ||
          (candidate.squared_distance == best && (triangle < 0 || number < triangle))) {
        best = candidate.squared_distance;
        found = candidate;
        triangle = number;
      }
    }
  }
  if (triangle < 0) return std::nullopt;
  return NearestPoint{triangle, found.point, found.barycentric, found.squared_distance};
}

NearestPoint TriangleTree::nearest(const Vec3& p) const {
  const auto found = nearest_within(p, kInfinity);
  require(found.has_value(), "query point is not finite: ", p.transpose());
  return *found;
}

std::optional<RayHit> TriangleTree::first_hit(const Vec3& origin, const Vec3& direction,
                                              double limit) const {
  const ShearedRay ray(origin, direction);
  std::optional<RayHit> best;
  double nearest = limit;
  std::array<Pending, kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, ray.entry(nodes_[0].low, nodes_[0].high, nearest)};
  while (depth > 0) {
    const Pending current = stack[--depth];
    if (!(current.key <= nearest)) continue;
    const Node& node = nodes_[static_cast<std::size_t>(current.node)];
    if (node.child != 0) {
      const Node* children = &nodes_[static_cast<std::size_t>(node.child)];
      Pending near{node.child, ray.entry(children[0].low, children[0].high, nearest)};
      Pending far{node.child + 1, ray.entry(children[1].low, children[1].high, nearest)};
      if (far.key < near.key) std::swap(near, far);
      if (far.key < kInfinity) stack[depth++] = far;
      if (near.key < kInfinity) stack[depth++] = near;
      continue;
    }
    for (Index i = node.begin; i < node.end; ++i) {
      const auto hit =
          ray.hit(&corners_[9 * static_cast<std::size_t>(i)], order_[static_cast<std::size_t>(i)]);
      if (!hit || hit->distance < 0.0 || hit->distance > nearest) continue;
      if (hit->distance < nearest || !best || hit->triangle < best->triangle) {
        best = hit;
        nearest = hit->distance;
      }
    }
  }
  return best;
}

std::vector<Index> TriangleTree::overlapping(const Vec3& low, const Vec3& high) const {
  const auto apart = [&](const Vec3& other_low, const Vec3& other_high) {
    return (other_low.array() > high.array()).any() || (other_high.array() < low.array()).any();
  };
  std::vector<Index> found;
  std::array<Index, kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
    if (apart(node.low, node.high)) continue;
    if (node.child != 0) {
      stack[depth++] = node.child + 1;
      stack[depth++] = node.child;
      continue;
    }
    for (Index i = node.begin; i < node.end; ++i) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3>> corners(
          &corners_[9 * static_cast<std::size_t>(i)]);
      if (!apart(corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()))
        found.push_back(order_[static_cast<std::size_t>(i)]);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

double TriangleTree::sign_at(const Vec3& p, const NearestPoint& nearest) const {
  const Index t = nearest.triangle;
  const Vec3 offset = p - nearest.point;
  const auto n_zero = (nearest.barycentric.array() == 0.0).count();
  Vec3 normal = Vec3::Zero();
  if (n_zero == 0) {
    normal = area_vector(points_, triangles_, t);
  } else {
    // sum over the triangles that share the vertex or the edge; a vertex weighs them by their angle
    int corner = 0;
    nearest.barycentric.maxCoeff(&corner);
    const Index vertex = triangles_(t, corner);
    Index other = vertex;
    for (int k = 0; k < 3; ++k)
      if (k != corner && nearest.barycentric[k] != 0.0) other = triangles_(t, k);
    for (Index i = ring_begin_[static_cast<std::size_t>(vertex)];
         i < ring_begin_[static_cast<std::size_t>(vertex) + 1]; ++i) {
      const Index s = ring_[static_cast<std::size_t>(i)];
      if (!contains(triangles_, s, other)) continue;
      const double weight =
          n_zero == 1 ? 1.0
                      : corner_angle(points_, triangles_, s, corner_of(triangles_, s, vertex));
      normal += weight * area_vector(points_, triangles_, s).normalized();
    }
  }
  return offset.dot(normal) < 0.0 ? -1.0 : 1.0;
}

double TriangleTree::signed_distance(const Vec3& p) const {
  const NearestPoint found = nearest(p);
  return sign_at(p, found) * std::sqrt(found.squared_distance);
}

}  // namespace coxa
