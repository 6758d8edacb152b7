#include <coxa/mesh/smooth.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>

namespace coxa {
namespace {

std::vector<bool> border_vertices(const TriMesh& mesh) {
  std::vector<bool> border(static_cast<std::size_t>(mesh.n_vertices()), false);
  const MeshEdges edges = mesh_edges(mesh);
  for (Index e = 0; e < edges.vertices.rows(); ++e)
    if (edges.triangles[e].size() == 1)
      for (int k = 0; k < 2; ++k) border[static_cast<std::size_t>(edges.vertices(e, k))] = true;
  return border;
}

Points stepped(const Points& points, const Adjacency& neighbours, const std::vector<bool>& fixed,
               double share) {
  Points next = points;
  parallel_for(points.rows(), [&](Index v) {
    if (fixed[static_cast<std::size_t>(v)] || neighbours[v].empty()) return;
    Vec3 sum = Vec3::Zero();
    for (Index other : neighbours[v]) sum += points.row(other).transpose();
    const Vec3 mean = sum / static_cast<double>(neighbours[v].size());
    next.row(v) += share * (mean - points.row(v).transpose()).transpose();
  });
  return next;
}

}  // namespace

TriMesh smoothed(const TriMesh& mesh, const SmoothOptions& options) {
  require(options.iterations >= 0, "smoothed: iterations must not be negative, got ",
          options.iterations);
  require(0.0 <= options.lambda && options.lambda <= 1.0,
          "smoothed: lambda must be in [0, 1], got ", options.lambda);
  require(-1.0 <= options.mu && options.mu <= 0.0, "smoothed: mu must be in [-1, 0], got ",
          options.mu);
  const Adjacency neighbours = vertex_neighbours(mesh);
  const std::vector<bool> border = border_vertices(mesh);
  TriMesh result = mesh;
  for (int i = 0; i < options.iterations; ++i) {
    result.points = stepped(result.points, neighbours, border, options.lambda);
    result.points = stepped(result.points, neighbours, border, options.mu);
  }
  return result;
}

}  // namespace coxa
