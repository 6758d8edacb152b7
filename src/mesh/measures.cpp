#include <coxa/mesh/measures.h>

#include <coxa/core/error.h>

#include <Eigen/Geometry>

#include <algorithm>

namespace coxa {
namespace {

struct Corners {
  Vec3 a, b, c;
  Corners(const TriMesh& mesh, Index t, const Vec3& origin)
      : a(mesh.points.row(mesh.triangles(t, 0)).transpose() - origin),
        b(mesh.points.row(mesh.triangles(t, 1)).transpose() - origin),
        c(mesh.points.row(mesh.triangles(t, 2)).transpose() - origin) {}
};

// near the surface, so that small differences of large tetrahedra do not cost digits
Vec3 origin_for(const TriMesh& mesh) {
  return mesh.empty() ? Vec3(Vec3::Zero()) : Vec3(mesh.points.row(mesh.triangles(0, 0)));
}

}  // namespace

VecX triangle_areas(const TriMesh& mesh) {
  VecX areas(mesh.n_triangles());
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Corners x(mesh, t, Vec3::Zero());
    areas[t] = 0.5 * (x.b - x.a).cross(x.c - x.a).norm();
  }
  return areas;
}

VecX piece_areas(const TriMesh& mesh, const std::vector<Index>& piece_of) {
  const VecX areas = triangle_areas(mesh);
  VecX sums =
      VecX::Zero(piece_of.empty() ? 0 : 1 + *std::max_element(piece_of.begin(), piece_of.end()));
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    sums[piece_of[static_cast<std::size_t>(t)]] += areas[t];
  return sums;
}

double area(const TriMesh& mesh) { return triangle_areas(mesh).sum(); }

double volume(const TriMesh& mesh) {
  double sum = 0.0;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Corners x(mesh, t, origin_for(mesh));
    sum += x.a.dot(x.b.cross(x.c));
  }
  return sum / 6.0;
}

Vec3 volume_centroid(const TriMesh& mesh) {
  Vec3 moment = Vec3::Zero();
  double sum = 0.0;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Corners x(mesh, t, origin_for(mesh));
    const double six_volumes = x.a.dot(x.b.cross(x.c));
    moment += six_volumes * (x.a + x.b + x.c) / 4.0;
    sum += six_volumes;
  }
  require(sum != 0.0, "volume_centroid: the surface encloses no volume");
  return origin_for(mesh) + moment / sum;
}

double mean_edge_length(const TriMesh& mesh) {
  require(!mesh.empty(), "mean_edge_length: the mesh has no triangle");
  double sum = 0.0;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Corners x(mesh, t, Vec3::Zero());
    sum += (x.b - x.a).norm() + (x.c - x.b).norm() + (x.a - x.c).norm();
  }
  return sum / (3.0 * mesh.n_triangles());
}

double percentile(VecX values, double share) {
  require(0.0 <= share && share <= 1.0, "percentile: share must be in [0, 1], got ", share);
  if (values.size() == 0) return kNaN;
  std::sort(values.data(), values.data() + values.size());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<Eigen::Index>(place);
  const auto above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

Bounds bounds(const Points& points) {
  require(points.rows() > 0, "bounds: no point");
  return {points.colwise().minCoeff(), points.colwise().maxCoeff()};
}

}  // namespace coxa
