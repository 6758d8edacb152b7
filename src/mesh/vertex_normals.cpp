#include <coxa/mesh/vertex_normals.h>

#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>

#include <cmath>

namespace coxa {
namespace {

Vec3 corner(const TriMesh& mesh, Index t, int k) {
  return mesh.points.row(mesh.triangles(t, k % 3));
}

}  // namespace

Points triangle_normals(const TriMesh& mesh) {
  Points normals(mesh.n_triangles(), 3);
  parallel_for(mesh.n_triangles(), [&](Index t) {
    const Vec3 a = corner(mesh, t, 0);
    normals.row(t) = (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a).normalized();
  });
  return normals;
}

Points vertex_normals(const TriMesh& mesh) {
  const Adjacency around = vertex_triangles(mesh);
  Points normals(mesh.n_vertices(), 3);
  parallel_for(mesh.n_vertices(), [&](Index v) {
    Vec3 sum = Vec3::Zero();
    for (Index t : around[v]) {
      const int k = mesh.triangles(t, 0) == v ? 0 : mesh.triangles(t, 1) == v ? 1 : 2;
      const Vec3 to_next = corner(mesh, t, k + 1) - corner(mesh, t, k);
      const Vec3 to_previous = corner(mesh, t, k + 2) - corner(mesh, t, k);
      const Vec3 normal = to_next.cross(to_previous);
      const double twice_area = normal.norm();
      if (twice_area > 0.0)
        sum += std::atan2(twice_area, to_next.dot(to_previous)) / twice_area * normal;
    }
    normals.row(v) = sum.normalized();
  });
  return normals;
}

}  // namespace coxa
