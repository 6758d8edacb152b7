#pragma once

#include "tet_grid.h"

#include <coxa/geom/triangle_tree.h>
#include <coxa/medial/face_pair.h>

#include <optional>

namespace coxa::meshing {

/// Where boundary nodes slide: the faces, the rim band and the border curves of a sheet.
class SlideGuide {
 public:
  /// @param rounding  mm: how far a knife-edge rim is moved inwards
  SlideGuide(const TriMesh& surface, const medial::SurfaceSides& sides,
             const medial::FacePair& faces, double rounding);

  /// The nearest place a node of this kind may take.
  Vec3 place(NodeKind kind, const Vec3& p) const;
  /// Orthonormal directions (columns) in which a node of this kind at p may move, 3, 2, 1 or 0.
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind kind, const Vec3& p) const;
  /// Nearest point on a sharp bend of a face; nullopt where the face has none.
  std::optional<Vec3> nearest_crease(NodeKind face, const Vec3& p) const;
  /// mm: largest distance between the rim and where it was moved.
  double largest_rounding() const { return largest_rounding_; }

 private:
  const medial::FacePair& faces_;
  std::optional<TriangleTree> band_;
  medial::BorderCurve rim_edge_, first_creases_, second_creases_;
  double largest_rounding_ = 0.0;
};

}  // namespace coxa::meshing
