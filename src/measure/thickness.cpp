#include <coxa/measure/thickness.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

namespace coxa::measure {

Eigen::VectorXd cartilage_thickness(const TriMesh& bone, const TriMesh& articular,
                                    const ThicknessOptions& options) {
  const double limit = options.max_thickness;
  const double offset = options.ray_offset;
  require(0 <= offset && offset < limit, "ray_offset must be in [0, ", limit, ") mm, got ", offset);
  require(!bone.empty() && !articular.empty(), "bone or articular mesh has no triangle");

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

}  // namespace coxa::measure
