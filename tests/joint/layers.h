#pragma once

#include <coxa/joint/joint_model.h>
#include <coxa/mesh/tet_mesh.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

/// Layered tetrahedral meshes with known shape, for the tests of the joint.
namespace coxa::test {

/// Unit directions on a cap about +z: `rings` rings out to polar angle `half_angle`, and its
/// triangles.
inline TriMesh cap_directions(double half_angle, Index rings) {
  TriMesh cap;
  const auto first = [](Index ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); };
  cap.points.resize(first(rings + 1), 3);
  cap.points.row(0) << 0, 0, 1;
  for (Index ring = 1; ring <= rings; ++ring) {
    const double polar = half_angle * ring / rings;
    for (Index k = 0; k < 6 * ring; ++k) {
      const double turn = 2.0 * kPi * k / (6.0 * ring);
      cap.points.row(first(ring) + k) << std::sin(polar) * std::cos(turn),
          std::sin(polar) * std::sin(turn), std::cos(polar);
    }
  }
  std::vector<std::array<Index, 3>> triangles;
  for (Index ring = 0; ring < rings; ++ring) {
    const Index n = std::max<Index>(1, 6 * ring), m = 6 * (ring + 1);
    for (Index sector = 0; sector < 6; ++sector) {
      for (Index k = 0; k <= ring; ++k) {
        const Index a = first(ring) + (sector * ring + k) % n,
                    b = first(ring) + (sector * ring + k + 1) % n;
        const Index c = first(ring + 1) + (sector * (ring + 1) + k) % m,
                    d = first(ring + 1) + (sector * (ring + 1) + k + 1) % m;
        triangles.push_back({a, c, d});
        if (k < ring) triangles.push_back({a, d, b});
      }
    }
  }
  cap.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      cap.triangles(static_cast<Index>(t), k) = triangles[t][static_cast<std::size_t>(k)];
  }
  return cap;
}

inline double tet_volume(const Points& p, const Eigen::Matrix<Index, 1, 4>& t) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = (p.row(t[k + 1]) - p.row(t[0])).transpose();
  return edges.determinant() / 6.0;
}

/// Prisms between consecutive sheets over the same triangles, three tetrahedra each; sheet 0 is the
/// bone side, the last the articular side.
inline TetMesh layered_mesh(const std::vector<Points>& sheets, const Triangles& triangles) {
  const Index n = static_cast<Index>(sheets.front().rows()),
              layers = static_cast<Index>(sheets.size()) - 1;
  TetMesh mesh;
  mesh.points.resize(n * (layers + 1), 3);
  for (Index s = 0; s <= layers; ++s)
    mesh.points.middleRows(s * n, n) = sheets[static_cast<std::size_t>(s)];
  mesh.tets.resize(3 * layers * triangles.rows(), 4);
  Index row = 0;
  for (Index s = 0; s < layers; ++s) {
    for (Index t = 0; t < triangles.rows(); ++t) {
      std::array<Index, 3> v{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
      std::sort(v.begin(), v.end());
      const Index low = s * n, high = low + n;
      mesh.tets.row(row++) << low + v[0], low + v[1], low + v[2], high + v[2];
      mesh.tets.row(row++) << low + v[0], low + v[1], high + v[1], high + v[2];
      mesh.tets.row(row++) << low + v[0], high + v[0], high + v[1], high + v[2];
    }
  }
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    if (tet_volume(mesh.points, mesh.tets.row(t)) < 0.0)
      std::swap(mesh.tets(t, 2), mesh.tets(t, 3));
  }
  // boundary: faces of one tetrahedron only, oriented outward
  std::map<std::array<Index, 3>, std::pair<int, std::array<Index, 3>>> faces;
  constexpr int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    for (const auto& corner : corners) {
      const std::array<Index, 3> face{mesh.tets(t, corner[0]), mesh.tets(t, corner[1]),
                                      mesh.tets(t, corner[2])};
      std::array<Index, 3> key = face;
      std::sort(key.begin(), key.end());
      auto& entry = faces[key];
      ++entry.first;
      entry.second = face;
    }
  }
  std::vector<std::array<Index, 3>> facets;
  for (const auto& [key, entry] : faces) {
    if (entry.first != 1) continue;
    facets.push_back(entry.second);
    const bool bone = key[2] < n, articular = key[0] >= layers * n;
    mesh.facet_tags.push_back(bone        ? FacetTag::bone_side
                              : articular ? FacetTag::articular_side
                                          : FacetTag::rim);
  }
  mesh.facets.resize(static_cast<Index>(facets.size()), 3);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    for (int k = 0; k < 3; ++k)
      mesh.facets(static_cast<Index>(f), k) = facets[f][static_cast<std::size_t>(k)];
  }
  return mesh;
}

/// Spherical shell over a cap about +z; the bone side has radius `bone`, the articular side
/// `articular`.
inline TetMesh cap_shell(double bone, double articular, double half_angle, Index rings,
                         Index layers, const Vec3& centre = Vec3::Zero()) {
  const TriMesh cap = cap_directions(half_angle, rings);
  std::vector<Points> sheets;
  for (Index s = 0; s <= layers; ++s) {
    const double radius = bone + (articular - bone) * s / layers;
    sheets.push_back((radius * cap.points).rowwise() + centre.transpose());
  }
  return layered_mesh(sheets, cap.triangles);
}

/// A ball of cartilage in a cup of cartilage, the cup's axis down -z: the femur is below, its force
/// goes up. Frames are the ISB axes turned so that superior (y) is image z.
struct BallInCup {
  double head_radius = 25.0;  ///< mm, of the femoral articular side
  double gap = 0.0;           ///< mm, cup radius minus head radius
  double thickness = 1.5;     ///< mm, of each layer
  double cup_angle = radians(60.0), head_angle = radians(80.0);
  Index cup_rings = 12, head_rings = 17, layers = 2;
  Vec3 head_offset = Vec3::Zero();  ///< mm, of the head in the image pose
};
inline joint::JointModel make_ball_in_cup(const BallInCup& shape = {}) {
  joint::JointModel model;
  const double R = shape.head_radius, cup = R + shape.gap, h = shape.thickness;
  model.acetabular_cartilage =
      cap_shell(cup + h, cup, shape.cup_angle, shape.cup_rings, shape.layers);
  model.femoral_cartilage =
      cap_shell(R - h, R, shape.head_angle, shape.head_rings, shape.layers, shape.head_offset);
  // x anterior = -y in LPS, y superior = z, z right = -x
  model.X_IP.R << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  model.X_IF = model.X_IP;
  return model;
}

}  // namespace coxa::test
