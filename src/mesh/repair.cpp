#include <coxa/mesh/repair.h>

#include "crowded_edges.h"
#include "editable_mesh.h"
#include "fill_holes.h"
#include "surface_parts.h"
#include "untangle.h"

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace coxa {
namespace {

TriMesh merge_points(TriMesh mesh, double distance, RepairReport& report) {
  // every vertex goes to the first earlier one within the distance, found in a window of the order
  // along x
  std::vector<Index> order(static_cast<std::size_t>(mesh.n_vertices())), target(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(target.begin(), target.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return mesh.points(a, 0) < mesh.points(b, 0); });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i;
         j-- > 0 && mesh.points(order[i], 0) - mesh.points(order[j], 0) <= distance;) {
      const double apart = (mesh.points.row(order[i]) - mesh.points.row(order[j])).norm();
      if (apart > distance) continue;
      target[static_cast<std::size_t>(order[i])] = target[static_cast<std::size_t>(order[j])];
      ++report.merged_points;
      report.largest_move = std::max(report.largest_move, apart);
      break;
    }
  for (Index i = 0; i < mesh.triangles.size(); ++i)
    mesh.triangles.data()[i] = target[static_cast<std::size_t>(mesh.triangles.data()[i])];
  return mesh;
}

TriMesh drop_degenerate_and_duplicates(const TriMesh& mesh, RepairReport& report) {
  std::vector<bool> marked(static_cast<std::size_t>(mesh.n_triangles()), false);
  std::vector<std::array<Index, 4>> keys;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    std::array<Index, 3> v{mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)};
    std::sort(v.begin(), v.end());
    if (v[0] == v[1] || v[1] == v[2])
      marked[static_cast<std::size_t>(t)] = true;
    else
      keys.push_back({v[0], v[1], v[2], t});
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (!std::equal(keys[i].begin(), keys[i].begin() + 3, keys[i - 1].begin())) continue;
    const Index first = keys[i - 1][3], second = keys[i][3];
    marked[static_cast<std::size_t>(second)] = true;
    // two that run opposite ways are a wall without thickness
    if (marked[static_cast<std::size_t>(first)]) continue;
    if (runs_along(mesh, first, keys[i][0], keys[i][1]) !=
        runs_along(mesh, second, keys[i][0], keys[i][1]))
      marked[static_cast<std::size_t>(first)] = true;
  }
  report.dropped_triangles += static_cast<Index>(std::count(marked.begin(), marked.end(), true));
  return without_marked(mesh, marked);
}

// turns triangles to agree with the lowest one of their piece
TriMesh orient_alike(TriMesh mesh, RepairReport& report) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<bool> reached(static_cast<std::size_t>(mesh.n_triangles()), false);
  std::vector<Index> pending;
  for (Index start = 0; start < mesh.n_triangles(); ++start) {
    if (reached[static_cast<std::size_t>(start)]) continue;
    reached[static_cast<std::size_t>(start)] = true;
    pending.push_back(start);
    while (!pending.empty()) {
      const Index t = pending.back();
      pending.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Index e = edges.of_triangle(t, k);
        if (edges.triangles[e].size() != 2) continue;
        for (Index other : edges.triangles[e]) {
          if (other == t) continue;
          const Index a = edges.vertices(e, 0), b = edges.vertices(e, 1);
          const bool against = runs_along(mesh, t, a, b) == runs_along(mesh, other, a, b);
          if (reached[static_cast<std::size_t>(other)]) {
            if (!against) continue;
            const Vec3 p = mesh.points.row(a);
            fail(ErrorCode::bad_mesh, "the surface is one-sided (a Moebius band) at (", p[0], ", ",
                 p[1], ", ", p[2], ") mm");
          }
          if (against) {
            std::swap(mesh.triangles(other, 1), mesh.triangles(other, 2));
            ++report.turned_triangles;
          }
          reached[static_cast<std::size_t>(other)] = true;
          pending.push_back(other);
        }
      }
    }
  }
  return mesh;
}

TriMesh turn_outward(TriMesh mesh, RepairReport& report) {
  const std::vector<Index> piece_of = triangle_components(mesh);
  const std::vector<bool> inward = inward_pieces(mesh, piece_of);
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (inward[static_cast<std::size_t>(piece_of[static_cast<std::size_t>(t)])]) {
      std::swap(mesh.triangles(t, 1), mesh.triangles(t, 2));
      ++report.turned_triangles;
    }
  return mesh;
}

struct Sides {
  Index shortest_a, shortest_b, longest_a, longest_b;
  double shortest, longest;
};
Sides sides_of(const EditableMesh& mesh, Index t) {
  const auto corners = mesh.triangle(t);
  Sides sides{0, 0, 0, 0, kInfinity, -1.0};
  for (std::size_t k = 0; k < 3; ++k) {
    const Index a = corners[k], b = corners[(k + 1) % 3];
    const double length = (mesh.point(a) - mesh.point(b)).norm();
    if (length < sides.shortest) {
      sides.shortest = length;
      sides.shortest_a = a;
      sides.shortest_b = b;
    }
    if (length > sides.longest) {
      sides.longest = length;
      sides.longest_a = a;
      sides.longest_b = b;
    }
  }
  return sides;
}

// needles lose their short edge, caps have their long edge flipped
TriMesh remove_slivers(const TriMesh& mesh, double ratio, RepairReport& report) {
  EditableMesh editable(mesh);
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    if (editable.triangle(t)[0] == editable.triangle(t)[1]) continue;
    const Sides s = sides_of(editable, t);
    if (2.0 * editable.area_vector(t).norm() >= ratio * s.longest * s.longest) continue;
    const Vec3 middle = 0.5 * (editable.point(s.shortest_a) + editable.point(s.shortest_b));
    if (s.shortest < 0.1 * s.longest && editable.can_collapse(s.shortest_a, s.shortest_b, middle)) {
      editable.collapse(s.shortest_a, s.shortest_b, middle);
      report.largest_move = std::max(report.largest_move, 0.5 * s.shortest);
    } else if (editable.can_flip(s.longest_a, s.longest_b)) {
      editable.flip(s.longest_a, s.longest_b);
    } else {
      continue;
    }
    ++report.removed_slivers;
  }
  return report.removed_slivers == 0 ? mesh : editable.result();
}

void check_input(const TriMesh& mesh, const RepairOptions& options) {
  require(options.merge_distance >= 0.0, "repair: merge_distance must not be negative, got ",
          options.merge_distance, " mm");
  require(options.max_hole >= 0.0, "repair: max_hole must not be negative, got ", options.max_hole,
          " mm");
  require(options.max_move >= 0.0, "repair: max_move must not be negative, got ", options.max_move,
          " mm");
  const bool readable = !mesh.empty() && mesh.triangles.minCoeff() >= 0 &&
                        mesh.triangles.maxCoeff() < mesh.n_vertices() && mesh.points.allFinite();
  if (!readable)
    fail(ErrorCode::bad_mesh, mesh.empty() ? "the surface has no triangle" : validate(mesh).text());
}

Index count_unused(const TriMesh& mesh) {
  const Adjacency around = vertex_triangles(mesh);
  Index unused = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) unused += around[v].empty();
  return unused;
}

}  // namespace

bool RepairReport::changed() const { return !lines().empty(); }

std::vector<std::string> RepairReport::lines() const {
  std::vector<std::string> lines;
  const auto say = [&](Index count, const char* what) {
    if (count > 0) lines.push_back(join_text(count, " ", what));
  };
  say(merged_points, "points merged with another");
  say(dropped_points, "unused points dropped");
  if (dropped_triangles > 0)
    lines.push_back(join_text(
        dropped_triangles, " degenerate, duplicate or dangling triangles dropped, which reached ",
        dropped_reach, " mm from what stays"));
  say(parted_edges, "edges made where more than two triangles shared one");
  say(split_vertices, "vertices doubled where sheets touched");
  say(turned_triangles, "triangles turned");
  if (filled_holes > 0)
    lines.push_back(join_text(filled_holes, " holes filled with ", hole_triangles,
                              " triangles, the longest border ", longest_hole, " mm"));
  say(removed_slivers, "slivers removed");
  say(untangled_triangles, "triangles replaced around self-intersections");
  if (!lines.empty())
    lines.push_back(join_text("the surface moved by at most ", largest_move, " mm"));
  return lines;
}

Repaired repair(const TriMesh& mesh, const RepairOptions& options) {
  check_input(mesh, options);
  Repaired result{mesh, {}};
  RepairReport& report = result.report;
  TriMesh& surface = result.mesh;
  report.dropped_points = count_unused(mesh);
  surface = merge_points(surface, options.merge_distance, report);
  surface = drop_degenerate_and_duplicates(surface, report);
  surface = drop_hanging_sheets(surface, report);
  surface = orient_alike(surface, report);
  surface = part_at_crowded_edges(surface, report);
  surface = split_touching_sheets(surface, report);
  surface = fill_holes(surface, options.max_hole, report);
  surface = remove_slivers(surface, options.sliver_ratio, report);
  surface = untangle(surface, options, report);
  surface = turn_outward(surface, report);
  require_closed_manifold(surface, "repair");
  return result;
}

}  // namespace coxa
