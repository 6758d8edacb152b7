#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/medial/surface_sides.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::medial {

/// Closed polylines, for example the border of a face.
struct BorderCurve {
  std::vector<std::vector<Vec3>> loops;
  struct Nearest {
    Vec3 point = Vec3::Zero();
    Vec3 tangent = Vec3::UnitX();  ///< unit, along the loop
  };
  Nearest nearest(const Vec3& p) const;
};

/// Where the ball around a medial point touches the two faces.
struct BallFeet {
  Vec3 first, second;
};

/// The two faces of a sheet-like body as search trees, with their border curves.
class FacePair {
 public:
  /// @throws Error bad_mesh if a face is empty or touches its own border
  FacePair(const TriMesh& surface, const SurfaceSides& sides);

  BallFeet feet(const Vec3& p) const;
  /// Moves p along the line between its feet until it is equally far from both faces.
  Vec3 centred(const Vec3& p) const;
  /// The point of the medial border nearest to p, halfway between the two face borders.
  Vec3 on_rim(const Vec3& p) const { return rim_.nearest(p).point; }
  /// Feet of a border node: the nearest points of the two border curves.
  BallFeet rim_feet(const Vec3& p) const;

  const TriMesh& first_face() const { return first_face_; }
  const TriMesh& second_face() const { return second_face_; }
  const TriangleTree& first_tree() const { return first_; }
  const TriangleTree& second_tree() const { return second_; }
  const BorderCurve& first_border() const { return first_border_; }
  const BorderCurve& second_border() const { return second_border_; }
  const BorderCurve& rim() const { return rim_; }

 private:
  TriMesh first_face_, second_face_;
  TriangleTree first_, second_;
  BorderCurve first_border_, second_border_, rim_;
};

/// The triangles with one label, vertices renumbered in order.
TriMesh face_of(const TriMesh& surface, const SurfaceSides& sides, SideLabel label);
/// The border loops of a face.
/// @throws Error bad_mesh if the border touches itself, naming the place
BorderCurve border_of(const TriMesh& face);

}  // namespace coxa::medial
