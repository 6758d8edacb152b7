#include "surface_places.h"

#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

constexpr double kSmoothCosine = 0.906;  // between the normals at an edge that is no ridge

}  // namespace

std::vector<Vec3> places_on(const TriMesh& surface, double spacing) {
  std::vector<Vec3> places;
  for (const auto& p : surface.points.rowwise()) places.push_back(p.transpose());
  const MeshEdges edges = mesh_edges(surface);
  const Points normals = triangle_normals(surface);
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    const Vec3 a = surface.points.row(edges.vertices(e, 0)),
               b = surface.points.row(edges.vertices(e, 1));
    const auto sides = edges.triangles[e];
    const bool ridge = normals.row(sides.front()).dot(normals.row(sides.back())) < kSmoothCosine;
    const int parts =
        ridge ? std::max(2, static_cast<int>(std::ceil((b - a).norm() / spacing))) : 2;
    for (int k = 1; k < parts; ++k) places.push_back(a + (b - a) * k / parts);
  }
  return places;
}

std::vector<Vec3> places_within(const TriMesh& surface, double spacing) {
  std::vector<Vec3> places;
  for (Index t = 0; t < surface.n_triangles(); ++t) {
    const Vec3 a = surface.points.row(surface.triangles(t, 0)),
               b = surface.points.row(surface.triangles(t, 1)),
               c = surface.points.row(surface.triangles(t, 2));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int parts = static_cast<int>(std::ceil(longest / spacing));
    for (int i = 1; i < parts; ++i)
      for (int j = 1; i + j < parts; ++j)
        places.push_back(a + (b - a) * i / parts + (c - a) * j / parts);
  }
  return places;
}

}  // namespace coxa::meshing
