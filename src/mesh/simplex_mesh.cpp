#include <coxa/mesh/simplex_mesh.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <cmath>
#include <vector>

namespace coxa {
namespace {

// weight of the pull to the face centroids against that of fitting the simplex vertices: it settles
// the modes that triangle centroids cannot see (three-colourings), and biases the others by half of
// it at most
constexpr double kCentroidPull = 1e-4;

Points face_centroids(const SimplexMesh& mesh) {
  Points centroids = Points::Zero(mesh.n_faces, 3);
  VecX counts = VecX::Zero(mesh.n_faces);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 3; ++k) {
      centroids.row(mesh.faces_of(v, k)) += mesh.points.row(v);
      counts[mesh.faces_of(v, k)] += 1.0;
    }
  return counts.cwiseInverse().asDiagonal() * centroids;
}

}  // namespace

SimplexMesh make_simplex_mesh(const TriMesh& surface) {
  require_closed_manifold(surface, "a simplex mesh");
  const MeshEdges edges = mesh_edges(surface);
  SimplexMesh mesh;
  mesh.faces_of = surface.triangles;
  mesh.n_faces = surface.n_vertices();
  mesh.points.resize(surface.n_triangles(), 3);
  mesh.neighbours.resize(surface.n_triangles(), 3);
  for (Index t = 0; t < surface.n_triangles(); ++t) {
    mesh.points.row(t) = surface.points(surface.triangles.row(t), Eigen::all).colwise().mean();
    for (int k = 0; k < 3; ++k) {
      const auto pair = edges.triangles[edges.of_triangle(t, k)];
      mesh.neighbours(t, k) = pair[0] == t ? pair[1] : pair[0];
    }
  }
  return mesh;
}

TriMesh dual_surface(const SimplexMesh& mesh) {
  // normal equations of sum |(q_a + q_b + q_c)/3 - P|² + pull sum |q - centroid|²
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(9 * mesh.n_vertices() + mesh.n_faces));
  const Points centroids = face_centroids(mesh);
  Points right = kCentroidPull * centroids;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int i = 0; i < 3; ++i) {
      right.row(mesh.faces_of(v, i)) += mesh.points.row(v) / 3.0;
      for (int j = 0; j < 3; ++j)
        entries.emplace_back(mesh.faces_of(v, i), mesh.faces_of(v, j), 1.0 / 9.0);
    }
  for (Index f = 0; f < mesh.n_faces; ++f) entries.emplace_back(f, f, kCentroidPull);
  Eigen::SparseMatrix<double> system(mesh.n_faces, mesh.n_faces);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(system);
  COXA_ASSERT(factors.info() == Eigen::Success);
  return {factors.solve(MatX(right)), mesh.faces_of};
}

TriMesh fan_surface(const SimplexMesh& mesh) {
  TriMesh fan;
  fan.points.resize(mesh.n_vertices() + mesh.n_faces, 3);
  fan.points << mesh.points, face_centroids(mesh);
  fan.triangles.resize(3 * mesh.n_vertices(), 3);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 3; ++k)
      fan.triangles.row(3 * v + k) << mesh.n_vertices() + mesh.faces_of(v, k), v,
          mesh.neighbours(v, (k + 2) % 3);
  return fan;
}

Points simplex_normals(const SimplexMesh& mesh) {
  Points normals(mesh.n_vertices(), 3);
  parallel_for(mesh.n_vertices(), [&](Index v) {
    const Vec3 A = mesh.points.row(mesh.neighbours(v, 0));
    const Vec3 AB = mesh.points.row(mesh.neighbours(v, 1)).transpose() - A;
    const Vec3 AC = mesh.points.row(mesh.neighbours(v, 2)).transpose() - A;
    normals.row(v) = AB.cross(AC).normalized();
  });
  return normals;
}

SimplexParameters simplex_parameters(const Vec3& P, const Vec3& A, const Vec3& B, const Vec3& C) {
  const Vec3 N = (B - A).cross(C - A);
  const double squared = N.squaredNorm();
  if (!(squared > 0.0)) return {};
  SimplexParameters parameters;
  parameters.metric[0] = (B - P).cross(C - P).dot(N) / squared;
  parameters.metric[1] = (C - P).cross(A - P).dot(N) / squared;
  parameters.metric[2] = 1.0 - parameters.metric[0] - parameters.metric[1];
  // N / |N|^1.5 √2 = n / √area, as the area is |N| / 2
  parameters.height = (P - A).dot(N) * std::sqrt(2.0) / std::pow(squared, 0.75);
  return parameters;
}

Vec3 position_from(const SimplexParameters& parameters, const Vec3& A, const Vec3& B,
                   const Vec3& C) {
  const Vec3 N = (B - A).cross(C - A);
  const double length = N.norm();
  const Vec3& e = parameters.metric;
  const Vec3 foot = e[0] * A + e[1] * B + e[2] * C;
  if (!(length > 0.0)) return foot;
  return foot + parameters.height / std::sqrt(2.0 * length) * N;
}

double simplex_angle(const Vec3& P, const Vec3& A, const Vec3& B, const Vec3& C) {
  // the centre of the sphere through P, A, B, C stands c = (d² + h² - r²) / 2h above the
  // circumcentre of ABC; then phi = atan2(s r, -s c) with s = sgn(h), multiplied by 2|h|
  const Vec3 b = B - A, c = C - A, N = b.cross(c);
  const double squared = N.squaredNorm();
  if (!(squared > 0.0)) return 0.0;
  const Vec3 n = N / std::sqrt(squared);
  const Vec3 centre =
      (c.squaredNorm() * N.cross(b) + b.squaredNorm() * c.cross(N)) / (2.0 * squared);
  const double r = centre.norm();
  const double h = (P - A).dot(n);
  const double squared_d = (P - A - h * n - centre).squaredNorm();
  return std::atan2(2.0 * h * r, r * r - squared_d - h * h);
}

}  // namespace coxa
