#pragma once

#include <coxa/core/types.h>
#include <coxa/geom/clock_face.h>
#include <coxa/geom/rigid_transform.h>
#include <coxa/joint/ligament.h>
#include <coxa/mesh/tet_mesh.h>
#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa::joint {

/// Elastic law of the cartilage.
enum class MaterialLaw { st_venant_kirchhoff, corotational, neo_hookean };

/// What resists the change of volume.
enum class VolumeChange {
  by_patches,  ///< patches of elements: no locking, nearly incompressible tissue too
  by_elements  ///< each by itself, as finite-element programs take four-node elements
};

/// The solid's share of cartilage's volume: when its fluid is out, no more can go (60 to 85 % of
/// its weight is water). Less is left of an element only where a thin edge is crushed.
inline constexpr double kSolidShare = 0.25;

struct CartilageMaterial {
  MaterialLaw law = MaterialLaw::corotational;
  double youngs_modulus = 12.0;  ///< MPa, > 0
  double poissons_ratio = 0.42;  ///< in (0, 0.5); with VolumeChange::by_elements in (-1, 0.5)
  VolumeChange volume_change = VolumeChange::by_patches;
};

/// Fibrocartilage as finite-element studies of the hip have taken it (docs/joint.md, Labrum).
inline constexpr CartilageMaterial kLabrumMaterial{
    .law = MaterialLaw::corotational, .youngs_modulus = 20.0, .poissons_ratio = 0.4};

/// Bare bone that the other side's cartilage may rest on.
enum class BareBone {
  hip_bone,  ///< the hip bone, by the femoral cartilage
  both       ///< the femur as well, by the acetabular cartilage
};

/// One hip in its image pose: everything in image space (LPS mm).
struct JointModel {
  Side side = Side::right;
  TetMesh acetabular_cartilage;  ///< boundary facets tagged bone_side, articular_side, rim
  TetMesh femoral_cartilage;     ///< likewise
  TriMesh hip_bone, femur;       ///< rigid, closed; both empty: the bony limit is not looked for
  TriMesh labrum;  ///< closed, rigid with the hip bone; empty: contact with it is not looked for
  /// Soft labrum that bears; no tetrahedra: none. Held where its facets are tagged bone_side, or
  /// without such tags where it lies on the hip bone.
  TetMesh labrum_body = {};
  /// ISB frames of pelvis and femur in the image pose (x anterior, y superior, z right), both with
  /// their origin at the joint centre.
  RigidTransform X_IP, X_IF;
  CartilageMaterial material;
  CartilageMaterial labrum_material = kLabrumMaterial;
  double friction = 0.0;  ///< coefficient of cartilage on cartilage, >= 0
  BareBone bare_bone = BareBone::hip_bone;
  std::vector<Ligament> ligaments = {};
};

/// @throws Error bad_input or bad_mesh naming what cannot be used: no tetrahedra, no articular or
/// bone-side facet,
///               a material value out of range, frames whose origins are apart, a ligament that
///               cannot be
void check_model(const JointModel& model);

/// Facets of a mesh that carry `tag`.
Triangles facets_with(const TetMesh& mesh, FacetTag tag);

/// Unit vector out of the socket, image frame: minus the mean direction of the acetabular articular
/// surface's push on the femur, that is the direction of its area-weighted mean normal.
Vec3 socket_axis(const JointModel& model);

/// Clock face of the socket about its axis and the joint centre; 12 superior, 3 anterior in the
/// pelvis frame.
ClockFace socket_clock(const JointModel& model);

}  // namespace coxa::joint
