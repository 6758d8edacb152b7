#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <string>
#include <vector>

namespace coxa {

struct RepairOptions {
  double merge_distance = 1e-5;  ///< mm, >= 0. Points this near become one.
  double max_hole = 60.0;        ///< mm, >= 0. A border longer than this is refused, not filled.
  double max_move =
      1.0;  ///< mm, >= 0. Self-intersections whose repair moves the surface more are refused.
  double sliver_ratio =
      1e-3;  ///< in [0, 1). Triangles flatter than this are removed where that folds nothing.
};

/// What was changed.
struct RepairReport {
  Index merged_points = 0;
  Index dropped_points = 0;     ///< that no triangle used
  Index dropped_triangles = 0;  ///< without area by their numbers, duplicates, fins
  double dropped_reach = 0.0;   ///< mm, of the farthest dropped triangle from those that stay
  Index parted_edges = 0;       ///< new in place of edges with more than two triangles
  Index split_vertices = 0;     ///< copies made where sheets touched in one vertex
  Index turned_triangles = 0;   ///< orientation reversed
  Index filled_holes = 0;
  Index hole_triangles = 0;  ///< new triangles in holes
  Index removed_slivers = 0;
  Index untangled_triangles = 0;  ///< removed around self-intersections and replaced
  double largest_move = 0.0;      ///< mm, of the surface, holes aside
  double longest_hole = 0.0;      ///< mm, border of the longest hole filled
  bool changed() const;
  /// One line per kind of change; empty without any.
  std::vector<std::string> lines() const;
};

struct Repaired {
  TriMesh mesh;
  RepairReport report;
};

/// Closed, manifold, outward surface without self-intersections, from one that nearly is.
///
/// In turn: merges points, drops degenerate and duplicate triangles and hanging sheets without
/// thickness, turns triangles to agree, separates what touches in an edge or a vertex, by 0.04 mm
/// at most, fills holes with the least area, removes slivers, cuts self-intersections out and fills
/// again, turns pieces outward. A surface without fault comes back as it is.
/// @throws Error bad_mesh, naming the place, for what cannot be repaired so
Repaired repair(const TriMesh& mesh, const RepairOptions& options = {});

}  // namespace coxa
