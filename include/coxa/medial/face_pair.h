#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/medial/surface_sides.h>
#include <coxa/medial/trim.h>
#include <coxa/mesh/tri_mesh.h>

#include <utility>
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
  /// The points `reach` mm before and after the point nearest to p, along its loop.
  std::pair<Vec3, Vec3> around(const Vec3& p, double reach) const;
};

/// Where the ball around a medial point touches the two faces.
struct BallFeet {
  Vec3 first, second;
};

/// Unit vectors in a face, at right angles to its border edges and pointing into it.
struct InwardField {
  std::vector<Vec3> places, directions;
  /// Mean direction near p, not normalised; border edges nearer than about `reach` mm count most.
  Vec3 mean(const Vec3& p, double reach) const;
};

/// The two faces where they meet at the rim.
struct RimWedge {
  Vec3 inward =
      Vec3::Zero();    ///< unit, halfway between the faces; zero where they give no direction
  double angle = kPi;  ///< rad, between the faces: small at a knife edge
};

/// The two faces of a sheet-like body as search trees, with their border curves.
class FacePair {
 public:
  /// @throws Error bad_mesh if a face is empty or touches its own border
  FacePair(const TriMesh& surface, const SurfaceSides& sides);

  BallFeet feet(const Vec3& p) const;
  /// Moves p along the line between its feet until it is equally far from both faces.
  Vec3 centred(const Vec3& p) const;
  /// Unit normal of the sheet near p, from the first face to the second; zero where it has none.
  Vec3 up(const Vec3& p) const;
  /// The point of the medial border nearest to p, halfway between the two face borders.
  Vec3 on_rim(const Vec3& p) const { return rim_.nearest(p).point; }
  /// Feet of a border node: the nearest points of the two border curves.
  BallFeet rim_feet(const Vec3& p) const;

  /// The wedge between the faces near a rim point, a mean over about 1 mm.
  RimWedge rim_wedge(const Vec3& p) const;

  /// Moves the rim to the border of a trimmed sheet; the faces stay as they are beyond it.
  void update_rim(const TrimmedSheet& trimmed);

  /// The sheet to start from, in the middle or near it, seen from the second face: the first face
  /// turned over, or the trimmed sheet.
  const TriMesh& start() const { return start_; }
  /// The wall across the sheet where it was trimmed; empty otherwise.
  const TriMesh& cut_wall() const { return cut_wall_; }

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
  InwardField first_inward_, second_inward_;
  TriMesh start_, cut_wall_;
};

/// The triangles with one label, vertices renumbered in order.
TriMesh face_of(const TriMesh& surface, const SurfaceSides& sides, SideLabel label);
InwardField inward_field(const TriMesh& face);
/// The border loops of a face.
/// @throws Error bad_mesh if the border touches itself, naming the place
BorderCurve border_of(const TriMesh& face);

}  // namespace coxa::medial
