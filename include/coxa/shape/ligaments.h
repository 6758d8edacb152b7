#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/shape/socket_rim.h>

#include <string>
#include <vector>

namespace coxa::shape {

/// Places of a right femur that attachments are described by, LPS mm.
struct FemurMarks {
  Vec3 head_centre = Vec3::Zero();
  Vec3 neck_centre = Vec3::Zero();  ///< inside the neck's middle
  Vec3 greater_trochanter = Vec3::Zero(), lesser_trochanter = Vec3::Zero();  ///< tips
};

/// A ligament as fibres side by side, each from bone to bone.
struct LigamentSite {
  std::string name;
  double thickness = 0.0;  ///< mm
  /// Per fibre: points on the bone's surface in the order the fibre runs over them. The origin's
  /// last and the insertion's first point are where it leaves the bone and comes to it.
  std::vector<std::vector<Vec3>> origin, insertion;
};

/// The names that find_ligament_sites knows.
const std::vector<std::string>& generic_ligament_names();

/// Where the ligaments of a hip are attached by the anatomical literature.
///
/// On the pelvis by hours about the rim and the footprints' depth (Nam et al. 2011, Telleria et al.
/// 2014), on the femur by the intertrochanteric line and the neck (Tamaki et al. 2023), in the head
/// at the fovea (Perumal et al. 2017).
/// @param hip_bone, femur  of a right hip, closed, LPS mm
/// @throws Error bad_input if a place is not found on the bones
std::vector<LigamentSite> find_ligament_sites(const SocketRim& rim, const TriMesh& hip_bone,
                                              const TriMesh& femur, const FemurMarks& marks);

/// Closed surface of a ligament: its fibres drawn tight between the attachments around what is in
/// their way, as thick as published or as the room allows.
/// @param firm  closed surfaces it keeps out of
/// @throws Error bad_mesh if the band cannot be made valid
TriMesh make_ligament(const LigamentSite& site, const Vec3& head_centre,
                      const std::vector<TriMesh>& firm);

}  // namespace coxa::shape
