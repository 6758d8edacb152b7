#pragma once

#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/remesh.h>
#include <coxa/shape/build_atlas.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace coxa::test {

/// An icosphere stretched along its axes by `factors`.
inline TriMesh ellipsoid(const Vec3& factors, int levels = 3) {
  TriMesh mesh = icosphere(levels, 10.0);
  mesh.points = mesh.points * factors.asDiagonal();
  return mesh;
}

/// Closed surface {f < 0} inside a cube of the given half size.
inline TriMesh implicit(const std::function<double(const Vec3&)>& f, double half, double grid,
                        double edge) {
  const auto n = static_cast<Index>(2.0 * half / grid) + 1;
  const auto place = [&](const Vec3& i) { return Vec3(grid * i - Vec3::Constant(half)); };
  std::vector<float> values;
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) values.push_back(static_cast<float>(-f(place(Vec3(i, j, k)))));
    }
  }
  return remesh(iso_surface({n, n, n}, values, 0.0, place), {.target_edge = edge});
}

/// A cap of a sphere about the origin, up to `angle` from +z, thickest in its middle; the first
/// half of the triangles is at radius `bone`.
inline TriMesh cap(double bone, double thickness, double angle, int rings = 6, int sectors = 18) {
  TriMesh mesh;
  const int sheet = 1 + rings * sectors, inner = sheet - sectors;
  mesh.points.resize(sheet + inner, 3);
  const auto place = [&](double radius, int ring, int sector) {
    const double a = angle * ring / rings, b = 2.0 * kPi * sector / sectors;
    return Vec3(radius * Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
  };
  const auto number = [&](int ring, int sector) {
    return ring == 0 ? 0 : 1 + (ring - 1) * sectors + sector % sectors;
  };
  for (int ring = 0; ring <= rings; ++ring) {
    for (int s = 0; s < (ring == 0 ? 1 : sectors); ++s) {
      const double share = 1.0 - static_cast<double>(ring * ring) / (rings * rings);
      mesh.points.row(number(ring, s)) = place(bone, ring, s);
      if (ring < rings)
        mesh.points.row(sheet + number(ring, s)) = place(bone + thickness * share, ring, s);
    }
  }
  std::vector<std::array<Index, 3>> faces;  // seen from outside the sphere
  for (int ring = 0; ring < rings; ++ring) {
    for (int s = 0; s < sectors; ++s) {
      const Index a = number(ring, s), b = number(ring + 1, s), c = number(ring + 1, s + 1),
                  d = number(ring, s + 1);
      faces.push_back({a, b, c});
      if (ring > 0) faces.push_back({a, c, d});
    }
  }
  const auto n = static_cast<Index>(faces.size());
  const bool outer_bone = thickness < 0.0;  // a socket's bone lies outside its cartilage
  mesh.triangles.resize(2 * n, 3);
  for (Index t = 0; t < n; ++t) {
    const auto& f = faces[static_cast<std::size_t>(t)];
    const auto other = [&](Index v) { return v < inner ? sheet + v : v; };
    const std::array<Index, 3> bone_side = {f[0], f[2], f[1]};
    const std::array<Index, 3> joint_side = {other(f[0]), other(f[1]), other(f[2])};
    for (int c = 0; c < 3; ++c) {
      const int k = outer_bone ? (3 - c) % 3 : c;
      mesh.triangles(t, c) = bone_side[static_cast<std::size_t>(k)];
      mesh.triangles(n + t, c) = joint_side[static_cast<std::size_t>(k)];
    }
  }
  return mesh;
}

/// A hip of spheres: a head on a rod along -z, a bowl above it, a cartilage on each.
inline shape::HipExample toy_hip(int number, double head, double rod) {
  shape::HipExample hip;
  hip.name = "toy/" + std::to_string(number);
  const double bowl = head + 4.1;
  hip.surfaces["femur"].mesh = implicit(
      [=](const Vec3& p) {
        const double sphere = p.norm() - head;
        const double radial = std::hypot(p.x(), p.y()) - rod;
        return std::min(sphere, std::max(radial, std::max(p.z(), -28.0 - p.z())));
      },
      32.0, 1.6, 2.4);
  hip.surfaces["hip_bone"].mesh = implicit(
      [=](const Vec3& p) {
        const double shell = std::max(bowl - p.norm(), p.norm() - bowl - 6.0);
        return std::max(shell, 1.0 - p.z());
      },
      26.0, 1.6, 2.6);
  hip.surfaces["femoral_cartilage"].mesh = cap(head + 0.1, 1.8, 1.2);
  hip.surfaces["acetabular_cartilage"].mesh = cap(bowl - 0.1, -1.6, 1.0);
  for (const char* name : {"femoral_cartilage", "acetabular_cartilage"})
    hip.bone_side_faces[name] = hip.surfaces[name].mesh.n_triangles() / 2;
  return hip;
}

inline std::vector<shape::HipExample> toy_hips() {
  return {toy_hip(1, 12.0, 4.5), toy_hip(2, 12.5, 5.5), toy_hip(3, 12.2, 5.0)};
}

inline shape::AtlasOptions toy_options() {
  shape::AtlasOptions options;
  options.structures = {{"femur", {2.6, 3}},
                        {"hip_bone", {2.8, 3}},
                        {"femoral_cartilage", {2.5, 3}},
                        {"acetabular_cartilage", {2.5, 3}}};
  options.registration = {.similarity_iterations = 8, .lengths = {20.0, 5.0, 2.0}, .iterations = 3};
  return options;
}

/// Built once for all tests of this program.
inline const shape::Atlas& toy_atlas() {
  static const shape::Atlas atlas = shape::build_atlas(toy_hips(), toy_options());
  return atlas;
}

}  // namespace coxa::test
