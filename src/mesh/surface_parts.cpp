#include "surface_parts.h"

#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>

#include <algorithm>

namespace coxa {

bool runs_along(const TriMesh& mesh, Index t, Index a, Index b) {
  for (int k = 0; k < 3; ++k)
    if (mesh.triangles(t, k) == a && mesh.triangles(t, (k + 1) % 3) == b) return true;
  return false;
}

std::vector<std::vector<std::vector<Index>>> vertex_fans(const TriMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  const Adjacency around = vertex_triangles(mesh);
  std::vector<std::vector<std::vector<Index>>> fans(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    std::vector<Index> left(around[v].begin(), around[v].end());
    while (!left.empty()) {
      // grow one fan over shared edges at v
      std::vector<Index> fan{left.front()};
      left.erase(left.begin());
      for (std::size_t i = 0; i < fan.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          const Index e = edges.of_triangle(fan[i], k);
          if (edges.vertices(e, 0) != v && edges.vertices(e, 1) != v) continue;
          if (edges.triangles[e].size() != 2) continue;
          for (Index t : edges.triangles[e]) {
            const auto place = std::find(left.begin(), left.end(), t);
            if (place == left.end()) continue;
            fan.push_back(t);
            left.erase(place);
          }
        }
      fans[static_cast<std::size_t>(v)].push_back(std::move(fan));
    }
  }
  return fans;
}

std::vector<bool> inward_pieces(const TriMesh& mesh, const std::vector<Index>& piece_of) {
  const Index n = piece_of.empty() ? 0 : 1 + *std::max_element(piece_of.begin(), piece_of.end());
  std::vector<std::vector<Index>> triangles(static_cast<std::size_t>(n));
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    triangles[static_cast<std::size_t>(piece_of[static_cast<std::size_t>(t)])].push_back(t);
  std::vector<TriMesh> pieces;
  for (const auto& list : triangles) pieces.push_back(sub_mesh(mesh, list).mesh);
  std::vector<bool> inward(pieces.size(), false);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    // a piece within an odd number of others is a cavity: its outside is turned inward
    bool cavity = false;
    const Vec3 p = pieces[i].points.row(0);
    const Bounds own = bounds(pieces[i].points);
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      const Bounds box = bounds(pieces[j].points);
      const bool contained =
          (own.low.array() > box.low.array()).all() && (own.high.array() < box.high.array()).all();
      if (j == i || !contained) continue;
      const double sign = volume(pieces[j]) < 0.0 ? -1.0 : 1.0;
      if (sign * TriangleTree(pieces[j].points, pieces[j].triangles).signed_distance(p) < 0.0)
        cavity = !cavity;
    }
    inward[i] = (volume(pieces[i]) < 0.0) != cavity;
  }
  return inward;
}

}  // namespace coxa
