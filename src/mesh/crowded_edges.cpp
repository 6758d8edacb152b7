#include "crowded_edges.h"

#include "surface_parts.h"

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/triangle_list.h>
#include <coxa/mesh/vertex_normals.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace coxa {
namespace {

constexpr double kApart = 0.02;       // mm: parts that touched are drawn back by this, or
constexpr double kApartShare = 0.02;  // by this share of the edges around where that is less

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// pieces that hang together over edges with two triangles
std::vector<Index> patches(const TriMesh& mesh, const MeshEdges& edges) {
  std::vector<Index> patch(at(mesh.n_triangles()), -1);
  Index n = 0;
  for (Index start = 0; start < mesh.n_triangles(); ++start) {
    if (patch[at(start)] >= 0) continue;
    std::vector<Index> pending{start};
    patch[at(start)] = n;
    while (!pending.empty()) {
      const Index t = pending.back();
      pending.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto around = edges.triangles[edges.of_triangle(t, k)];
        if (around.size() != 2) continue;
        for (const Index other : around) {
          if (patch[at(other)] >= 0) continue;
          patch[at(other)] = n;
          pending.push_back(other);
        }
      }
    }
    ++n;
  }
  return patch;
}

// which patches hang on a crowded edge and end in the open; the largest one never
std::vector<bool> hanging(const TriMesh& mesh, const MeshEdges& edges,
                          const std::vector<Index>& patch) {
  const std::size_t n = at(1 + *std::max_element(patch.begin(), patch.end()));
  std::vector<bool> crowded(n, false), open(n, false);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const std::size_t p = at(patch[at(t)]);
    for (int k = 0; k < 3; ++k) {
      const std::size_t count = edges.triangles[edges.of_triangle(t, k)].size();
      crowded[p] = crowded[p] || count > 2;
      open[p] = open[p] || count == 1;
    }
  }
  Eigen::Index largest = 0;
  piece_areas(mesh, patch).maxCoeff(&largest);
  std::vector<bool> result(n, false);
  for (std::size_t p = 0; p < n; ++p)
    result[p] = crowded[p] && open[p] && p != static_cast<std::size_t>(largest);
  return result;
}

double farthest_from(const TriMesh& rest, const TriMesh& whole, const std::vector<bool>& marked) {
  const TriangleTree tree(rest.points, rest.triangles);
  double farthest = 0.0;
  for (Index t = 0; t < whole.n_triangles(); ++t)
    for (int k = 0; k < 3 && marked[at(t)]; ++k)
      farthest = std::max(farthest,
                          tree.nearest(whole.points.row(whole.triangles(t, k))).squared_distance);
  return std::sqrt(farthest);
}

// A wedge of the body at a crowded edge: the triangle that runs against it and the one along it.
struct Wedge {
  Index against, along;
};

// Triangles around the edge from a to b by angle: the body lies behind one that runs against it, up
// to one that runs along it, so they pair like brackets.
std::vector<Wedge> wedges_of(const TriMesh& mesh, Index a, Index b,
                             std::span<const Index> triangles) {
  const Vec3 p = mesh.points.row(a), axis = (mesh.points.row(b) - mesh.points.row(a)).normalized();
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  struct Side {
    double angle;
    Index t;
    bool along;
  };
  std::vector<Side> sides;
  for (const Index t : triangles) {
    const Vec3 middle = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
    sides.push_back(
        {std::atan2(v.dot(middle - p), u.dot(middle - p)), t, runs_along(mesh, t, a, b)});
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& s, const Side& t) { return s.angle < t.angle; });
  std::vector<Wedge> wedges;
  std::vector<Index> waiting;
  for (int turn = 0; turn < 2; ++turn)
    for (Side& side : sides) {
      if (side.t < 0) continue;
      if (!side.along && turn == 0) waiting.push_back(side.t);
      if (!side.along || waiting.empty()) continue;
      wedges.push_back({waiting.back(), side.t});
      waiting.pop_back();
      side.t = -1;
    }
  if (2 * wedges.size() != triangles.size())
    fail(ErrorCode::bad_mesh, triangles.size(), " triangles share an edge at (", p[0], ", ", p[1],
         ", ", p[2], ") mm and do not bound wedges of a body");
  return wedges;
}

// New vertices at the middles of crowded edges: their places, and one per triangle and edge.
struct Middles {
  std::vector<Vec3> places;
  Triangles of_triangle;  // -1 where the edge stays whole
};

Middles part_edges(const TriMesh& mesh, RepairReport& report) {
  const MeshEdges edges = mesh_edges(mesh);
  const Points normals = triangle_normals(mesh);
  Middles middles{{}, Triangles::Constant(mesh.n_triangles(), 3, -1)};
  for (Index e = 0; e < edges.vertices.rows(); ++e) {
    if (edges.triangles[e].size() <= 2) continue;
    const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
    const Vec3 p = mesh.points.row(a), q = mesh.points.row(b);
    for (const auto& [against, along] : wedges_of(mesh, a, b, edges.triangles[e])) {
      const Vec3 outward = (normals.row(against) + normals.row(along)).transpose();
      const double apart = std::min(kApart, kApartShare * (q - p).norm());
      const Index made = mesh.n_vertices() + static_cast<Index>(middles.places.size());
      middles.places.push_back(0.5 * (p + q) - apart * outward / std::max(1.0, outward.norm()));
      report.largest_move = std::max(report.largest_move, apart);
      ++report.parted_edges;
      for (const Index t : {against, along})
        for (int k = 0; k < 3; ++k)
          if (edges.of_triangle(t, k) == e) middles.of_triangle(t, k) = made;
    }
  }
  return middles;
}

// the triangle in parts, with vertices in the middles of some of its edges
void add_parts(const Eigen::Matrix<Index, 1, 3>& corners, const Eigen::Matrix<Index, 1, 3>& middle,
               std::vector<std::array<Index, 3>>& parts) {
  std::vector<Index> loop;
  for (int k = 0; k < 3; ++k) {
    // a corner between two parted edges is cut off at once
    if (middle[k] >= 0 && middle[(k + 2) % 3] >= 0)
      parts.push_back({corners[k], middle[k], middle[(k + 2) % 3]});
    else
      loop.push_back(corners[k]);
    if (middle[k] >= 0) loop.push_back(middle[k]);
  }
  // what is left has at most four corners; it is cut from a middle
  const auto first =
      std::find_if(loop.begin(), loop.end(), [&](Index v) { return v > corners.maxCoeff(); });
  if (first != loop.end()) std::rotate(loop.begin(), first, loop.end());
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    parts.push_back({loop[0], loop[k], loop[k + 1]});
}

}  // namespace

TriMesh without_marked(const TriMesh& mesh, const std::vector<bool>& marked) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (!marked[at(t)]) kept.push_back(t);
  if (kept.empty()) fail(ErrorCode::bad_mesh, "no triangle of the surface is usable");
  return sub_mesh(mesh, kept).mesh;
}

TriMesh drop_hanging_sheets(TriMesh mesh, RepairReport& report) {
  while (true) {
    const MeshEdges edges = mesh_edges(mesh);
    const std::vector<Index> patch = patches(mesh, edges);
    const std::vector<bool> goes = hanging(mesh, edges, patch);
    std::vector<bool> marked(at(mesh.n_triangles()), false);
    for (Index t = 0; t < mesh.n_triangles(); ++t) marked[at(t)] = goes[at(patch[at(t)])];
    const auto n = std::count(marked.begin(), marked.end(), true);
    if (n == 0) return mesh;
    TriMesh rest = without_marked(mesh, marked);
    report.dropped_triangles += static_cast<Index>(n);
    report.dropped_reach = std::max(report.dropped_reach, farthest_from(rest, mesh, marked));
    mesh = std::move(rest);
  }
}

TriMesh part_at_crowded_edges(const TriMesh& mesh, RepairReport& report) {
  const Middles middles = part_edges(mesh, report);
  if (middles.places.empty()) return mesh;
  TriMesh parted = mesh;
  parted.points.conservativeResize(mesh.n_vertices() + static_cast<Index>(middles.places.size()),
                                   3);
  for (std::size_t i = 0; i < middles.places.size(); ++i)
    parted.points.row(mesh.n_vertices() + static_cast<Index>(i)) = middles.places[i];
  std::vector<std::array<Index, 3>> triangles;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    add_parts(mesh.triangles.row(t), middles.of_triangle.row(t), triangles);
  parted.triangles = triangles_from(triangles);
  return parted;
}

TriMesh split_touching_sheets(TriMesh mesh, RepairReport& report) {
  const TriMesh before = mesh;
  const Points normals = triangle_normals(mesh);
  const auto fans = vertex_fans(mesh);
  Index next = mesh.n_vertices();
  for (const auto& fan_list : fans)
    next += fan_list.empty() ? 0 : static_cast<Index>(fan_list.size()) - 1;
  mesh.points.conservativeResize(next, 3);
  next = before.n_vertices();
  for (Index v = 0; v < before.n_vertices(); ++v) {
    if (fans[at(v)].size() < 2) continue;
    for (std::size_t fan = 0; fan < fans[at(v)].size(); ++fan) {
      const Vec3 place = before.points.row(v);
      const Index copy = fan == 0 ? v : next++;
      Vec3 outward = Vec3::Zero();
      double shortest = kInfinity;
      for (const Index t : fans[at(v)][fan]) {
        outward += normals.row(t).transpose();
        for (int k = 0; k < 3; ++k) {
          const Index corner = before.triangles(t, k);
          if (corner == v)
            mesh.triangles(t, k) = copy;
          else
            shortest = std::min(shortest, (before.points.row(corner).transpose() - place).norm());
        }
      }
      const double apart = std::min(kApart, kApartShare * shortest);
      mesh.points.row(copy) = place - apart * outward / std::max(1.0, outward.norm());
      report.largest_move = std::max(report.largest_move, apart);
      report.split_vertices += fan > 0;
    }
  }
  return mesh;
}

}  // namespace coxa
