#include <coxa/segment/seat.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/simplex_mesh.h>

#include <Eigen/Geometry>

namespace coxa::segment {
namespace {

/// mm. The examples keep a layer about 0.1 mm off its bone, and remeshing adds as much again.
constexpr double kSeatDistance = 0.45;
/// Share of a layer's vertices that touch its host: nearly half of a closed sheet's.
constexpr double kSeatedShare = 0.2;
/// A host has many times the volume of the layer on it; two touching layers have about the same.
constexpr double kVolumeRatio = 3.0;

}  // namespace

TriangleFrame triangle_frame(const TriMesh& mesh, Index triangle, const Vec3& barycentric) {
  const Vec3 a = mesh.points.row(mesh.triangles(triangle, 0)).transpose();
  const Vec3 b = mesh.points.row(mesh.triangles(triangle, 1)).transpose();
  const Vec3 c = mesh.points.row(mesh.triangles(triangle, 2)).transpose();
  TriangleFrame frame;
  frame.origin = barycentric[0] * a + barycentric[1] * b + barycentric[2] * c;
  const Vec3 normal = (b - a).cross(c - a).normalized();
  const Vec3 along = (b - a).normalized();
  frame.axes << along, normal.cross(along), normal;
  return frame;
}

VecX seated_vertices(const shape::StructureModel& layer, const TriMesh& host_mean) {
  const SimplexMesh& mesh = layer.hierarchy.levels.back();
  const Points normals = simplex_normals(mesh);
  const TriangleTree tree(host_mean.points, host_mean.triangles);
  VecX seated = VecX::Zero(mesh.n_vertices());
  parallel_for(mesh.n_vertices(), [&](Index v) {
    const auto near = tree.nearest_within(mesh.points.row(v).transpose(), kSeatDistance);
    if (!near) return;
    const TriangleFrame frame = triangle_frame(host_mean, near->triangle, near->barycentric);
    if (frame.axes.col(2).dot(normals.row(v).transpose()) < -0.3) seated[v] = 1.0;
  });
  return seated;
}

std::vector<std::optional<std::size_t>> find_hosts(
    const std::vector<const shape::StructureModel*>& structures) {
  std::vector<TriMesh> means;
  std::vector<double> volumes;
  for (const shape::StructureModel* model : structures) {
    means.push_back(dual_surface(model->hierarchy.levels.back()));
    volumes.push_back(volume(means.back()));
  }
  std::vector<std::optional<std::size_t>> hosts(structures.size());
  for (std::size_t layer = 0; layer < structures.size(); ++layer) {
    double best = kSeatedShare;
    for (std::size_t host = 0; host < structures.size(); ++host) {
      if (host == layer || volumes[host] < kVolumeRatio * volumes[layer]) continue;
      const double share = seated_vertices(*structures[layer], means[host]).mean();
      if (share > best) {
        best = share;
        hosts[layer] = host;
      }
    }
  }
  return hosts;
}

Points carried_points(const Points& points, const TriMesh& before, const TriMesh& now) {
  COXA_ASSERT(before.triangles.rows() == now.triangles.rows());
  const TriangleTree tree(before.points, before.triangles);
  Points carried(points.rows(), 3);
  parallel_for(points.rows(), [&](Index v) {
    const Vec3 p = points.row(v).transpose();
    const NearestPoint near = tree.nearest(p);
    const TriangleFrame from = triangle_frame(before, near.triangle, near.barycentric);
    const TriangleFrame to = triangle_frame(now, near.triangle, near.barycentric);
    carried.row(v) =
        (to.origin + to.axes * (from.axes.transpose() * (p - from.origin))).transpose();
  });
  return carried;
}

}  // namespace coxa::segment
