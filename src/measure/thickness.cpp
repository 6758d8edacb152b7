#include <coxa/measure/thickness.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>

namespace coxa::measure {
namespace {

// a ray steps this far past a triangle that it has met, mm
constexpr double kStep = 1e-6;

void check(const TriMesh& bone, const TriMesh& articular, const ThicknessOptions& options) {
  const double limit = options.max_thickness, offset = options.ray_offset;
  require(0 <= offset && offset < limit, "ray_offset must be in [0, ", limit, ") mm, got ", offset);
  require(!bone.empty() && !articular.empty(), "bone or articular mesh has no triangle");
}

Vec3 area_normal(const TriMesh& mesh, Index t) {
  const Vec3 a = mesh.points.row(mesh.triangles(t, 0)), b = mesh.points.row(mesh.triangles(t, 1)),
             c = mesh.points.row(mesh.triangles(t, 2));
  return (b - a).cross(c - a);
}

}  // namespace

Eigen::VectorXd cartilage_thickness(const TriMesh& bone, const TriMesh& articular,
                                    const ThicknessOptions& options) {
  check(bone, articular, options);
  const double limit = options.max_thickness, offset = options.ray_offset;
  const Points normals = vertex_normals(bone);  // V×3, unit length
  const TriangleTree tree(articular.points, articular.triangles);
  Eigen::VectorXd thickness(bone.n_vertices());

  // each vertex writes only its own slot: no lock, no reduction, no order to lose
  parallel_for(bone.n_vertices(), [&](Index v) {
    const Vec3 normal = normals.row(v);
    const Vec3 start = bone.points.row(v).transpose() + offset * normal;
    const auto hit = tree.first_hit(start, normal, limit - offset);
    thickness[v] = hit ? hit->distance + offset : kNaN;
  });
  return thickness;
}

Eigen::VectorXd closed_cartilage_thickness(const TriMesh& bone, const TriMesh& cartilage,
                                           const ThicknessOptions& options) {
  check(bone, cartilage, options);
  const double limit = options.max_thickness;
  const Points normals = vertex_normals(bone);
  const TriangleTree tree(cartilage.points, cartilage.triangles);
  Eigen::VectorXd thickness = Eigen::VectorXd::Constant(bone.n_vertices(), kNaN);
  parallel_for(bone.n_vertices(), [&](Index v) {
    const Vec3 normal = normals.row(v), start = bone.points.row(v);
    double from = options.ray_offset;
    while (from < limit) {
      const auto hit = tree.first_hit(start + from * normal, normal, limit - from);
      if (!hit) return;
      from += hit->distance;
      if (area_normal(cartilage, hit->triangle).dot(normal) > 0.0) {
        thickness[v] = from;
        return;
      }
      from += kStep;
    }
  });
  return thickness;
}

}  // namespace coxa::measure
