#include <coxa/mesh/unfold.h>

#include <coxa/mesh/topology.h>
#include <coxa/mesh/validate.h>

#include <vector>

namespace coxa {
namespace {

constexpr int kRounds = 25;
constexpr int kPasses = 3;
constexpr double kStep = 0.5;  // share of the way to the mean of the neighbours

/// Grows the set of marked vertices by their neighbours.
std::vector<bool> grown(const std::vector<bool>& marked, const Adjacency& neighbours) {
  std::vector<bool> more = marked;
  for (Index v = 0; v < neighbours.size(); ++v) {
    for (const Index w : neighbours[v])
      if (marked[static_cast<std::size_t>(w)]) more[static_cast<std::size_t>(v)] = true;
  }
  return more;
}

void update_evened(TriMesh& mesh, const std::vector<bool>& marked, const Adjacency& neighbours) {
  const Points before = mesh.points;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!marked[static_cast<std::size_t>(v)]) continue;
    Vec3 sum = Vec3::Zero();
    for (const Index w : neighbours[v]) sum += before.row(w);
    const Vec3 middle = sum / static_cast<double>(neighbours[v].size());
    mesh.points.row(v) += kStep * (middle.transpose() - before.row(v));
  }
}

// those with a marked corner
std::vector<Index> triangles_of(const TriMesh& mesh, const std::vector<bool>& marked) {
  std::vector<Index> found;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int c = 0; c < 3; ++c)
      if (marked[static_cast<std::size_t>(mesh.triangles(t, c))]) {
        found.push_back(t);
        break;
      }
  return found;
}

}  // namespace

bool update_unfolded(TriMesh& mesh) {
  const Adjacency neighbours = vertex_neighbours(mesh);
  auto pairs = self_intersections(mesh);
  for (int round = 0; round < kRounds && !pairs.empty(); ++round) {
    std::vector<bool> marked(static_cast<std::size_t>(mesh.n_vertices()), false);
    for (const auto& pair : pairs) {
      for (const Index t : pair) {
        for (int c = 0; c < 3; ++c) marked[static_cast<std::size_t>(mesh.triangles(t, c))] = true;
      }
    }
    // a place that does not come free in six rounds is evened together with one more ring
    for (int ring = 0; ring <= round / 6; ++ring) marked = grown(marked, neighbours);
    for (int pass = 0; pass < kPasses; ++pass) update_evened(mesh, marked, neighbours);
    // pairs of triangles that stayed where they are did not meet before
    pairs = self_intersections(mesh, triangles_of(mesh, marked));
  }
  return pairs.empty();
}

}  // namespace coxa
