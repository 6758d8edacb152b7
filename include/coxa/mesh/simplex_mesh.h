#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa {

/// 2-simplex mesh (Delingette 1999): every vertex has exactly three neighbours; dual of a
/// triangulation.
///
/// Vertex i of the simplex mesh is triangle i of the dual triangulation `dual`, so its neighbours
/// are the triangles across that triangle's edges, and each face of the simplex mesh is a vertex of
/// `dual`.
struct SimplexMesh {
  Points points;         ///< V×3, mm
  Triangles neighbours;  ///< V×3, counter-clockwise seen from outside: k is across the edge from
                         ///< face k to face k+1
  Triangles faces_of;    ///< V×3 face numbers, = triangles of the dual: face k lies between
                         ///< neighbours k-1 and k
  Index n_faces = 0;

  Index n_vertices() const { return static_cast<Index>(points.rows()); }
};

/// Position of a vertex described by its neighbours A, B, C: P = e1 A + e2 B + e3 C + height n.
struct SimplexParameters {
  Vec3 metric = Vec3::Constant(1.0 / 3.0);  ///< e1, e2, e3, sum 1
  double height = 0.0;                      ///< divided by sqrt(area of ABC): similarity-invariant
};

/// Topology of the dual of a closed, oriented, manifold triangulation; points are triangle
/// centroids.
/// @throws Error bad_mesh if the surface is open, not manifold, or inconsistently oriented
SimplexMesh make_simplex_mesh(const TriMesh& surface);

/// Triangulation dual to the simplex mesh whose triangle centroids are (in the least-squares sense,
/// with a tiny pull to the face centroids) the simplex vertices: conversion without shrinkage.
TriMesh dual_surface(const SimplexMesh& mesh);

/// Triangulation that keeps the simplex vertices and adds the centroid of each face (fan).
TriMesh fan_surface(const SimplexMesh& mesh);

/// Unit normal at every simplex vertex: normal of the triangle of its three neighbours, outward;
/// V×3.
Points simplex_normals(const SimplexMesh& mesh);

/// Parameters of vertex position P with respect to neighbours A, B, C.
SimplexParameters simplex_parameters(const Vec3& P, const Vec3& A, const Vec3& B, const Vec3& C);
/// The position these parameters describe.
Vec3 position_from(const SimplexParameters& parameters, const Vec3& A, const Vec3& B,
                   const Vec3& C);
/// Simplex angle phi in (-pi, pi], 0 when flat, positive where the surface is convex. rad.
double simplex_angle(const Vec3& P, const Vec3& A, const Vec3& B, const Vec3& C);

/// One coarser level: the sparse rows say how fine vertices follow coarse ones.
struct LevelMap {
  /// For each fine vertex, three coarse vertices and weights (sum 1).
  Triangles parents;  ///< Vfine×3
  Points weights;     ///< Vfine×3
};

/// Resolutions of one structure, coarse first; maps[l] takes level l to level l+1.
struct SimplexHierarchy {
  std::vector<SimplexMesh> levels;
  std::vector<LevelMap> maps;
};

}  // namespace coxa
