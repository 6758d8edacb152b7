#pragma once

#include <coxa/core/rng.h>
#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa::test {

/// A thin closed shell drawn at random: plate, cap or lunate strip; 0.5 to 4 mm thick; curved
/// either way; with notches, a hole, a knife edge or a wall as rim, and noise on its faces.
struct RandomShell {
  TriMesh surface;
  double thickness = 0.0;  ///< mm, the largest
  double noise = 0.0;      ///< mm, standard deviation
  bool knife_edge = false;
  bool ring = false;  ///< has a hole
};

namespace random_shell_detail {

struct Shape {
  bool wraps = false, pole = false, knife_edge = false;
  Index nu = 0, nv = 0;             // cells around and across
  double span = 0.0;                // rad around
  double inner = 0.0, outer = 0.0;  // mm from the axis, along the surface
  double k1 = 0.0, k2 = 0.0;        // principal curvatures, 1/mm
  double thickness = 0.0, unevenness = 0.0, phase = 0.0, taper = 0.0;
  double notch_at = 0.0, notch_depth = 0.0, notch_width = 0.0;
};

inline Vec3 middle(const Shape& s, double u, double v) {
  const double angle = s.span * u;
  const double away = (u - s.notch_at) * s.span / s.notch_width;
  const double outer = s.outer - (s.outer - s.inner) * s.notch_depth * std::exp(-away * away);
  const double r = s.inner + (outer - s.inner) * v;
  const double x = r * std::cos(angle), y = r * std::sin(angle);
  // height of a surface with these curvatures; flattens out so that it never stands on edge
  const double bend = 0.5 * (s.k1 * x * x + s.k2 * y * y);
  return {x, y, bend};
}

inline Vec3 normal(const Shape& s, double u, double v) {
  const Vec3 p = middle(s, u, v);
  return Vec3(-s.k1 * p[0], -s.k2 * p[1], 1.0).normalized();
}

inline double thickness(const Shape& s, double u, double v) {
  const double swing = std::sin(s.span * u * 2.0 + s.phase) * std::cos(3.0 * v + s.phase);
  const double full = s.thickness * (1.0 - s.unevenness * 0.5 * (1.0 + swing));
  if (!s.knife_edge) return full;
  double edge = 1.0 - v;
  if (!s.pole) edge = std::min(edge, v);
  if (!s.wraps)
    edge = std::min({edge, u * s.span * s.outer / (s.outer - s.inner),
                     (1.0 - u) * s.span * s.outer / (s.outer - s.inner)});
  return full * std::clamp(edge / s.taper, 0.0, 1.0);
}

inline Shape draw(Rng& rng) {
  Shape s;
  const int kind = static_cast<int>(rng.below(3));  // strip, ring, disc
  s.wraps = kind != 0;
  s.pole = kind == 2;
  s.knife_edge = rng.uniform() < 0.5;
  s.thickness = 0.5 * std::pow(8.0, rng.uniform());
  s.unevenness = rng.uniform(0.0, 0.5);
  s.phase = rng.uniform(0.0, 2.0 * kPi);
  s.inner = s.pole ? 0.0 : rng.uniform(8.0, 14.0);
  s.outer = s.inner + rng.uniform(10.0, 18.0);
  s.span = s.wraps ? 2.0 * kPi : rng.uniform(1.0, 5.0);
  s.k1 = rng.uniform(-1.0, 1.0) / 25.0;
  s.k2 = rng.uniform(-1.0, 1.0) / 25.0;
  s.taper = std::max(0.15, s.thickness / (s.outer - s.inner) / rng.uniform(0.25, 0.7));
  s.notch_at = rng.uniform(0.3, 0.7);
  s.notch_depth = rng.uniform(0.0, 0.45);
  s.notch_width = rng.uniform(0.2, 0.6);
  const double edge = std::min(rng.uniform(0.8, 2.0), 1.5 * s.thickness);
  s.nu = std::max<Index>(12, static_cast<Index>(s.span * s.outer / edge));
  s.nv = std::max<Index>(5, static_cast<Index>((s.outer - s.inner) / edge));
  return s;
}

}  // namespace random_shell_detail

inline RandomShell random_shell(std::uint64_t seed) {
  namespace detail = random_shell_detail;
  Rng rng(seed);
  const detail::Shape s = detail::draw(rng);
  RandomShell made;
  made.thickness = s.thickness;
  made.knife_edge = s.knife_edge;
  made.ring = s.wraps && !s.pole;
  made.noise = rng.uniform(0.0, 0.03) * s.thickness;

  const Index columns = s.wraps ? s.nu : s.nu + 1;
  std::vector<Vec3> points;
  // numbers of the nodes of both faces; shared where a knife edge or the pole closes
  std::vector<std::vector<Index>> face[2];
  for (int side = 0; side < 2; ++side) face[side].assign(std::size_t(s.nv) + 1, {});
  for (int side = 0; side < 2; ++side) {
    for (Index j = 0; j <= s.nv; ++j) {
      auto& row = face[side][std::size_t(j)];
      for (Index i = 0; i < columns; ++i) {
        const double u = double(i) / s.nu, v = double(j) / s.nv;
        const double t = detail::thickness(s, u, v);
        if (s.pole && j == 0 && i > 0) {
          row.push_back(row[0]);
        } else if (side == 1 && t < 1e-9) {
          row.push_back(face[0][std::size_t(j)][std::size_t(i)]);
        } else {
          const double shake = t < 1e-9 ? 0.0 : std::min(made.noise, 0.1 * t) * rng.normal();
          const double offset = (side == 0 ? -0.5 : 0.5) * t + std::clamp(shake, -0.2 * t, 0.2 * t);
          row.push_back(static_cast<Index>(points.size()));
          points.push_back(detail::middle(s, u, v) + offset * detail::normal(s, u, v));
        }
      }
    }
  }
  std::vector<Eigen::Matrix<Index, 1, 3>> triangles;
  const auto add = [&](Index a, Index b, Index c) {
    if (a != b && b != c && c != a) triangles.emplace_back(a, b, c);
  };
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    add(a, b, c);
    add(a, c, d);
  };
  const auto id = [&](int side, Index i, Index j) {
    return face[side][std::size_t(j)][std::size_t(i % columns)];
  };
  for (Index j = 0; j < s.nv; ++j) {
    for (Index i = 0; i < s.nu; ++i) {
      const Index a = i, b = i + 1, c = j, d = j + 1;
      // at corners the diagonal leaves the corner: no triangle has all its nodes on the rim
      if ((i == 0 && d == s.nv) || (b == s.nu && j == 0)) {
        quad(id(1, b, c), id(1, a, c), id(1, a, d), id(1, b, d));
        quad(id(0, b, c), id(0, b, d), id(0, a, d), id(0, a, c));
      } else {
        quad(id(1, a, c), id(1, a, d), id(1, b, d), id(1, b, c));
        quad(id(0, a, c), id(0, b, c), id(0, b, d), id(0, a, d));
      }
    }
  }
  for (Index i = 0; i < s.nu; ++i) {
    quad(id(0, i, s.nv), id(0, i + 1, s.nv), id(1, i + 1, s.nv), id(1, i, s.nv));
    if (!s.pole) quad(id(1, i, 0), id(1, i + 1, 0), id(0, i + 1, 0), id(0, i, 0));
  }
  for (Index j = 0; j < s.nv && !s.wraps; ++j) {
    quad(id(0, 0, j), id(0, 0, j + 1), id(1, 0, j + 1), id(1, 0, j));
    quad(id(1, s.nu, j), id(1, s.nu, j + 1), id(0, s.nu, j + 1), id(0, s.nu, j));
  }
  made.surface.points.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    made.surface.points.row(static_cast<Index>(i)) = points[i];
  }
  made.surface.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    made.surface.triangles.row(static_cast<Index>(t)) = triangles[t];
  }
  return made;
}

}  // namespace coxa::test
