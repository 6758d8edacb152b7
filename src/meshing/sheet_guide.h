#pragma once

#include "slide_guide.h"

#include <coxa/geom/triangle_tree.h>
#include <coxa/medial/face_pair.h>

#include <optional>

namespace coxa::meshing {

/// Guide of a sheet: its faces, the rim band and the border curves.
class SheetGuide : public SlideGuide {
 public:
  /// @param faces     must outlive the guide
  /// @param rounding  mm: how far a knife-edge rim is moved inwards
  SheetGuide(const TriMesh& surface, const medial::SurfaceSides& sides,
             const medial::FacePair& faces, double rounding);

  Vec3 place(NodeKind kind, const Vec3& p) const override;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> directions(NodeKind kind,
                                                               const Vec3& p) const override;
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
