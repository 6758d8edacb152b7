#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace coxa {

enum class FaultKind {
  bad_index,            ///< a triangle names a vertex that is not there
  not_finite,           ///< a coordinate is NaN or infinite
  duplicate_point,      ///< vertices at the same place
  unused_vertex,        ///< no triangle uses it
  degenerate_triangle,  ///< without area
  duplicate_triangle,   ///< the same three vertices as another
  sliver,               ///< height below `sliver_ratio` of its longest edge; a warning
  open_boundary,        ///< an edge with one triangle
  non_manifold_edge,    ///< an edge with more than two triangles
  non_manifold_vertex,  ///< sheets that touch in one vertex
  mixed_orientation,    ///< two triangles that run the same way along their edge
  inward_orientation,   ///< a closed piece turned inside out
  self_intersection  ///< triangles without a common vertex that touch, or neighbours that fold over
};
/// The kind in words: "open boundary".
std::string_view name(FaultKind kind);

/// One kind of fault found, and where first.
struct Fault {
  FaultKind kind = FaultKind::bad_index;
  Index count = 0;            ///< places (edges, vertices, triangles or pairs of triangles)
  Index first = 0;            ///< vertex for kinds about vertices, else triangle
  Vec3 place = Vec3::Zero();  ///< mm
};
/// "3 edges with one triangle (open boundary), first at (1, 2, 3) mm".
std::string describe(const Fault& fault);

struct ValidateOptions {
  double sliver_ratio = 1e-3;  ///< in [0, 1)
};

/// What is wrong with a surface that should be closed, manifold, outward and free of
/// self-intersections.
struct ValidityReport {
  std::vector<Fault> faults;  ///< in the order of FaultKind; empty for a flawless surface
  /// No fault but slivers.
  bool valid() const;
  bool has(FaultKind kind) const;
  /// All faults described, one after another; "no fault" without any.
  std::string text() const;
};
/// @note exact: intersections and planarity are decided without rounding. Cost O(T log T).
ValidityReport validate(const TriMesh& mesh, const ValidateOptions& options = {});

/// Pairs of triangles that meet where they should not: pairs without a common vertex that touch or
/// cross, and pairs with one that share more than it. Triangles without area are skipped. Each pair
/// ascending, sorted.
std::vector<std::array<Index, 2>> self_intersections(const TriMesh& mesh);
/// The same, only of pairs with one of `some` triangles (ascending) in them.
std::vector<std::array<Index, 2>> self_intersections(const TriMesh& mesh,
                                                     const std::vector<Index>& some);

}  // namespace coxa
