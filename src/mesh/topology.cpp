#include <coxa/mesh/topology.h>

#include "surface_parts.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace coxa {
namespace {

// lists from (owner, item) pairs; items keep the order in which they come
Adjacency gather(Index n, const std::vector<std::pair<Index, Index>>& pairs) {
  Adjacency lists;
  lists.begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (const auto& pair : pairs) ++lists.begin[static_cast<std::size_t>(pair.first) + 1];
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  lists.items.resize(pairs.size());
  std::vector<Index> next = lists.begin;
  for (const auto& [owner, item] : pairs)
    lists.items[static_cast<std::size_t>(next[static_cast<std::size_t>(owner)]++)] = item;
  return lists;
}

void check_indices(const TriMesh& mesh) {
  if (mesh.empty()) return;
  const Index low = mesh.triangles.minCoeff(), high = mesh.triangles.maxCoeff();
  if (low < 0 || high >= mesh.n_vertices())
    fail(ErrorCode::bad_mesh, "a triangle names vertex ", low < 0 ? low : high,
         ", but vertices are numbered 0 to ", mesh.n_vertices() - 1);
}

std::string place(const TriMesh& mesh, Index v) {
  const Vec3 p = mesh.points.row(v);
  return join_text("vertex ", v, " at (", p[0], ", ", p[1], ", ", p[2], ") mm");
}

std::string edge_fault(const TriMesh& mesh, const MeshEdges& edges) {
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
    const auto around = edges.triangles[e];
    if (a == b) return join_text("a triangle names the same vertex twice: ", place(mesh, a));
    if (around.size() == 1)
      return join_text("the surface is open at the edge from ", place(mesh, a), " to ",
                       place(mesh, b));
    if (around.size() > 2)
      return join_text(around.size(), " triangles share the edge from ", place(mesh, a), " to ",
                       place(mesh, b));
    if (runs_along(mesh, around[0], a, b) == runs_along(mesh, around[1], a, b))
      return join_text("the two triangles at the edge from ", place(mesh, a), " to ",
                       place(mesh, b), " are oriented against each other");
  }
  return {};
}

// how many triangles one meets walking around vertex v over shared edges
std::size_t fan_size(const TriMesh& mesh, std::span<const Index> around, Index v) {
  std::map<Index, Index> leaving;   // x -> triangle with directed edge v -> x
  std::map<Index, Index> entering;  // triangle -> x of its directed edge x -> v
  for (Index t : around)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles(t, k) == v) {
        leaving[mesh.triangles(t, (k + 1) % 3)] = t;
        entering[t] = mesh.triangles(t, (k + 2) % 3);
      }
  std::size_t count = 0;
  Index t = around[0];
  do {
    ++count;
    t = leaving.at(entering.at(t));
  } while (t != around[0] && count <= around.size());
  return count;
}

Index find_root(std::vector<Index>& parent, Index i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    const Index up = parent[static_cast<std::size_t>(i)];
    parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

}  // namespace

MeshEdges mesh_edges(const TriMesh& mesh) {
  check_indices(mesh);
  using TriangleSide = std::array<Index, 3>;  // lower vertex, higher vertex, 3 * triangle + k
  std::vector<TriangleSide> sides;
  sides.reserve(static_cast<std::size_t>(mesh.triangles.size()));
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3));
      sides.push_back({low, high, 3 * t + k});
    }
  std::sort(sides.begin(), sides.end());

  MeshEdges edges;
  edges.of_triangle.resize(mesh.n_triangles(), 3);
  edges.triangles.items.reserve(sides.size());
  edges.triangles.begin.clear();
  std::vector<Index> ends;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i][0] != sides[i - 1][0] || sides[i][1] != sides[i - 1][1]) {
      edges.triangles.begin.push_back(static_cast<Index>(i));
      ends.insert(ends.end(), {sides[i][0], sides[i][1]});
    }
    edges.of_triangle.data()[sides[i][2]] = static_cast<Index>(edges.triangles.begin.size()) - 1;
    edges.triangles.items.push_back(sides[i][2] / 3);
  }
  edges.triangles.begin.push_back(static_cast<Index>(sides.size()));
  edges.vertices =
      Eigen::Map<decltype(edges.vertices)>(ends.data(), static_cast<Index>(ends.size() / 2), 2);
  return edges;
}

Adjacency vertex_triangles(const TriMesh& mesh) {
  check_indices(mesh);
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(static_cast<std::size_t>(mesh.triangles.size()));
  for (Index i = 0; i < mesh.triangles.size(); ++i)
    pairs.emplace_back(mesh.triangles.data()[i], i / 3);
  return gather(mesh.n_vertices(), pairs);
}

Adjacency vertex_neighbours(const TriMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(static_cast<std::size_t>(edges.vertices.size()));
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    pairs.emplace_back(edges.vertices(e, 0), edges.vertices(e, 1));
    pairs.emplace_back(edges.vertices(e, 1), edges.vertices(e, 0));
  }
  std::sort(pairs.begin(), pairs.end());
  return gather(mesh.n_vertices(), pairs);
}

std::vector<Index> triangle_components(const TriMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<Index> parent(static_cast<std::size_t>(mesh.n_triangles()));
  std::iota(parent.begin(), parent.end(), 0);
  for (Index e = 0; e < edges.vertices.rows(); ++e)
    for (Index t : edges.triangles[e]) {
      const Index a = find_root(parent, edges.triangles[e][0]), b = find_root(parent, t);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<Index> number(parent.size(), 0);
  Index count = 0;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Index root = find_root(parent, t);
    number[static_cast<std::size_t>(t)] =
        root == t ? count++ : number[static_cast<std::size_t>(root)];
  }
  return number;
}

std::vector<std::vector<Index>> boundary_loops(const TriMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::map<Index, Index> next;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (edges.triangles[edges.of_triangle(t, k)].size() != 1) continue;
      const Index from = mesh.triangles(t, k);
      if (!next.emplace(from, mesh.triangles(t, (k + 1) % 3)).second)
        fail(ErrorCode::bad_mesh, "two borders touch at ", place(mesh, from));
    }
  std::vector<std::vector<Index>> loops;
  while (!next.empty()) {
    std::vector<Index> loop;
    for (auto step = next.begin(); step != next.end();) {
      loop.push_back(step->first);
      const Index to = step->second;
      next.erase(step);
      step = next.find(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

Index euler_characteristic(const TriMesh& mesh) {
  std::vector<bool> used(static_cast<std::size_t>(mesh.n_vertices()), false);
  const auto n_edges = static_cast<Index>(mesh_edges(mesh).vertices.rows());
  for (Index i = 0; i < mesh.triangles.size(); ++i)
    used[static_cast<std::size_t>(mesh.triangles.data()[i])] = true;
  return static_cast<Index>(std::count(used.begin(), used.end(), true)) - n_edges +
         mesh.n_triangles();
}

Index genus(const TriMesh& mesh) {
  require_closed_manifold(mesh, "genus");
  const std::vector<Index> pieces = triangle_components(mesh);
  const Index n_pieces = 1 + *std::max_element(pieces.begin(), pieces.end());
  return n_pieces - euler_characteristic(mesh) / 2;
}

std::string manifold_fault(const TriMesh& mesh) {
  if (mesh.empty()) return "it has no triangle";
  const MeshEdges edges = mesh_edges(mesh);
  if (std::string fault = edge_fault(mesh, edges); !fault.empty()) return fault;
  const Adjacency around = vertex_triangles(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (around[v].empty()) return join_text("no triangle uses ", place(mesh, v));
    if (fan_size(mesh, around[v], v) != around[v].size())
      return join_text("two sheets touch only at ", place(mesh, v));
  }
  return {};
}

void require_closed_manifold(const TriMesh& mesh, const std::string& what) {
  const std::string fault = manifold_fault(mesh);
  if (!fault.empty())
    fail(ErrorCode::bad_mesh, what, " needs a closed, oriented, manifold surface: ", fault);
}

SubMesh sub_mesh(const TriMesh& mesh, std::span<const Index> triangles) {
  constexpr Index kUnused = -1;
  std::vector<Index> number(static_cast<std::size_t>(mesh.n_vertices()), kUnused);
  for (Index t : triangles)
    for (int k = 0; k < 3; ++k) number[static_cast<std::size_t>(mesh.triangles(t, k))] = 0;
  SubMesh part;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (number[static_cast<std::size_t>(v)] != kUnused) {
      number[static_cast<std::size_t>(v)] = static_cast<Index>(part.vertex_of.size());
      part.vertex_of.push_back(v);
    }
  part.mesh.points = mesh.points(part.vertex_of, Eigen::all);
  part.mesh.triangles.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      part.mesh.triangles(static_cast<Index>(i), k) =
          number[static_cast<std::size_t>(mesh.triangles(triangles[i], k))];
  return part;
}

}  // namespace coxa
