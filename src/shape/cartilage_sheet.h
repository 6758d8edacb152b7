#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::shape {

/// The two sides of a cartilage.
struct CartilageSides {
  TriMesh bone_side;  ///< open sheet, its normals look into the bone
  TriMesh articular;  ///< open sheet, its normals look into the joint
};

/// Cuts a closed cartilage whose first `n_bone_side` triangles lie on the bone.
/// @throws Error bad_mesh if that is none or all of its triangles
CartilageSides split_cartilage(const TriMesh& shell, Index n_bone_side);

/// The same with the sides told apart by the bone: a triangle is on the bone's side when it looks
/// at the bone's nearest point.
CartilageSides split_cartilage(const TriMesh& shell, const TriMesh& bone);

/// The sheet with a new vertex on every inner edge that joins two border vertices, so that two
/// copies of it can share their border.
TriMesh without_border_chords(TriMesh sheet);

/// Two copies of one sheet joined at their border: bone side first, then the articular side.
///
/// Triangle i + n lies opposite triangle i; vertices of the sheet come first, then those of the
/// articular side without the border.
struct ShellTopology {
  Triangles triangles;  ///< 2n×3
  std::vector<Index>
      articular_vertex;  ///< per sheet vertex: shell vertex opposite, itself at the border
  Index n_sheet_vertices = 0, n_vertices = 0;

  /// @param articular rows per sheet vertex; those of the border are not used
  Points points(const Points& sheet, const Points& articular) const;
};
ShellTopology make_shell(const TriMesh& sheet);

/// The point of the articular side opposite every vertex of a bone-side sheet: along the normal, or
/// the nearest one where the normal misses (at the rim).
Points opposite_points(const TriMesh& sheet, const TriMesh& articular);

}  // namespace coxa::shape
