#pragma once

#include <coxa/core/rng.h>
#include <coxa/core/types.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/mesh/tri_mesh.h>

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

/// Shapes with known answers, shared by the tests.
namespace coxa::test {

/// Flat square [-half, half]² at height z, normal +z, of n×n cells of two triangles. Open.
inline TriMesh plate(double z, double half = 10.0, Index n = 10) {
  TriMesh mesh;
  mesh.points.resize((n + 1) * (n + 1), 3);
  mesh.triangles.resize(2 * n * n, 3);
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i)
      mesh.points.row(j * (n + 1) + i) << half * (2.0 * i / n - 1.0), half * (2.0 * j / n - 1.0), z;
  for (Index j = 0, t = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i, t += 2) {
      const Index v = j * (n + 1) + i;
      mesh.triangles.row(t) << v, v + 1, v + n + 2;
      mesh.triangles.row(t + 1) << v, v + n + 2, v + n + 1;
    }
  return mesh;
}

/// Closed grid of u×v quads (both directions wrap), two triangles each; position(s, t), s and t in
/// [0, 1).
template <class Position>
TriMesh wrapped_grid(Index u, Index v, const Position& position) {
  TriMesh mesh;
  mesh.points.resize(u * v, 3);
  mesh.triangles.resize(2 * u * v, 3);
  for (Index j = 0, t = 0; j < v; ++j)
    for (Index i = 0; i < u; ++i, t += 2) {
      const Index i1 = (i + 1) % u, j1 = (j + 1) % v;
      mesh.points.row(j * u + i) = position(double(i) / u, double(j) / v).transpose();
      mesh.triangles.row(t) << j * u + i, j * u + i1, j1 * u + i1;
      mesh.triangles.row(t + 1) << j * u + i, j1 * u + i1, j1 * u + i;
    }
  return mesh;
}

/// Closed surface of revolution about the x axis through `profile` (x, radius), outward.
inline TriMesh revolved(const std::vector<Vec2>& profile, Index around) {
  const auto rings = static_cast<Index>(profile.size());
  TriMesh mesh;
  mesh.points.resize(rings * around + 2, 3);
  for (Index r = 0; r < rings; ++r) {
    const Vec2& p = profile[static_cast<std::size_t>(r)];
    for (Index k = 0; k < around; ++k) {
      const double turn = 2.0 * kPi * k / around;
      mesh.points.row(r * around + k) << p.x(), p.y() * std::cos(turn), p.y() * std::sin(turn);
    }
  }
  const Index first = rings * around, last = first + 1;
  mesh.points.row(first) << profile.front().x(), 0, 0;
  mesh.points.row(last) << profile.back().x(), 0, 0;
  std::vector<Eigen::RowVector3i> triangles;
  for (Index k = 0; k < around; ++k) {
    const Index next = (k + 1) % around;
    triangles.emplace_back(first, next, k);
    triangles.emplace_back(last, (rings - 1) * around + k, (rings - 1) * around + next);
    for (Index r = 0; r + 1 < rings; ++r) {
      const Index a = r * around + k, b = r * around + next;
      triangles.emplace_back(a, b, b + around);
      triangles.emplace_back(a, b + around, a + around);
    }
  }
  mesh.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.row(static_cast<Index>(t)) = triangles[t];
  return mesh;
}

/// Both surfaces as one mesh, the vertices and triangles of `a` first.
inline TriMesh together(TriMesh a, const TriMesh& b) {
  const Index n = a.n_vertices(), m = a.n_triangles();
  a.points.conservativeResize(n + b.n_vertices(), 3);
  a.points.bottomRows(b.n_vertices()) = b.points;
  a.triangles.conservativeResize(m + b.n_triangles(), 3);
  a.triangles.bottomRows(b.n_triangles()) = b.triangles.array() + n;
  return a;
}

/// The surface inside out.
inline TriMesh turned_over(TriMesh mesh) {
  mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

/// Torus about z: genus 1.
inline TriMesh torus(double major = 10.0, double minor = 3.0, Index u = 48, Index v = 24) {
  return wrapped_grid(u, v, [=](double s, double t) {
    const double a = 2.0 * kPi * s, b = 2.0 * kPi * t, r = major + minor * std::cos(b);
    return Vec3(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
  });
}

/// Axis-aligned box of 12 triangles.
inline TriMesh box(const Vec3& low = Vec3::Constant(-1.0), const Vec3& high = Vec3::Constant(1.0)) {
  TriMesh mesh;
  mesh.points.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.points.row(i) << ((i & 1) ? high : low)[0], ((i & 2) ? high : low)[1],
        ((i & 4) ? high : low)[2];
  mesh.triangles.resize(12, 3);
  mesh.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
      0, 6, 2, 1, 3, 7, 1, 7, 5;
  return mesh;
}

/// Sphere from an icosahedron split `levels` times (20·4^levels triangles); vertices lie on the
/// sphere.
inline TriMesh icosphere(int levels = 3, double radius = 10.0, const Vec3& centre = Vec3::Zero()) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Vec3> points{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                           {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                           {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  Triangles triangles(20, 3);
  triangles << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7,
      6, 7, 1, 8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7,
      9, 8, 1;
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [place, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (fresh)
        points.push_back((points[static_cast<std::size_t>(a)].normalized() +
                          points[static_cast<std::size_t>(b)].normalized()));
      return place->second;
    };
    Triangles finer(4 * triangles.rows(), 3);
    for (Index t = 0; t < triangles.rows(); ++t) {
      const Index a = triangles(t, 0), b = triangles(t, 1), c = triangles(t, 2);
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.middleRows<4>(4 * t) << a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca;
    }
    triangles = finer;
  }
  TriMesh mesh;
  mesh.triangles = triangles;
  mesh.points.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.row(static_cast<Index>(i)) = (centre + radius * points[i].normalized()).transpose();
  return mesh;
}

/// Thin closed shell like acetabular cartilage: a lunate strip of the sphere of `radius` (inner
/// face), `thickness` thick outward, spanning `span` about z and `width` in latitude. Rad, mm.
inline TriMesh lunate_shell(double radius = 25.0, double thickness = 1.6,
                            double span = radians(230.0), double width = radians(45.0),
                            Index around = 96, Index across = 20) {
  const Index nu = around + 1, nv = across + 1;
  TriMesh mesh;
  mesh.points.resize(2 * nu * nv, 3);
  for (Index side = 0; side < 2; ++side)
    for (Index j = 0; j < nv; ++j)
      for (Index i = 0; i < nu; ++i) {
        const double a = span * (double(i) / around - 0.5), b = width * (double(j) / across - 0.5);
        const double r = radius + side * thickness;
        mesh.points.row((side * nv + j) * nu + i) << r * std::cos(b) * std::cos(a),
            r * std::cos(b) * std::sin(a), r * std::sin(b);
      }
  std::vector<Eigen::Matrix<Index, 1, 3>> triangles;
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    triangles.emplace_back(a, b, c);
    triangles.emplace_back(a, c, d);
  };
  const auto id = [&](Index side, Index i, Index j) { return (side * nv + j) * nu + i; };
  for (Index j = 0; j < across; ++j)
    for (Index i = 0; i < around; ++i) {
      quad(id(1, i, j), id(1, i + 1, j), id(1, i + 1, j + 1), id(1, i, j + 1));
      quad(id(0, i, j), id(0, i, j + 1), id(0, i + 1, j + 1), id(0, i + 1, j));
    }
  for (Index i = 0; i < around; ++i) {
    quad(id(0, i, 0), id(0, i + 1, 0), id(1, i + 1, 0), id(1, i, 0));
    quad(id(1, i, across), id(1, i + 1, across), id(0, i + 1, across), id(0, i, across));
  }
  for (Index j = 0; j < across; ++j) {
    quad(id(1, 0, j), id(1, 0, j + 1), id(0, 0, j + 1), id(0, 0, j));
    quad(id(0, around, j), id(0, around, j + 1), id(1, around, j + 1), id(1, around, j));
  }
  mesh.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.row(static_cast<Index>(t)) = triangles[t];
  return mesh;
}

/// A pose without any symmetry.
inline RigidTransform some_pose() {
  return {rotation_from_vector(Vec3(0.3, -0.7, 1.1)), Vec3(12.0, -34.0, 56.0)};
}

inline TriMesh moved(TriMesh mesh, const RigidTransform& X) {
  mesh.points = transformed(mesh.points, X);
  return mesh;
}

/// n points, each coordinate uniform in [-half, half] mm.
inline Points random_points(Index n, double half, std::uint64_t seed) {
  Rng rng(seed);
  Points points(n, 3);
  for (Index i = 0; i < points.size(); ++i) points.data()[i] = rng.uniform(-half, half);
  return points;
}

}  // namespace coxa::test
