#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/joint/joint_model.h>
#include <coxa/joint/load_case.h>

#include <vector>

#include "elasticity.h"
#include "hip_contact.h"
#include "labrum_body.h"
#include "ligament_force.h"

namespace coxa::joint {

/// Where the femur's bone is, beside the translation found: rotation about the joint centre, then a
/// shift.
struct BonePose {
  Mat3 R = Mat3::Identity();
  Vec3 shift = Vec3::Zero();  ///< mm, of the joint centre, image axes
};

/// The pose a share s in [0, 1] of the way from a to b: constant axis, constant rate.
BonePose between(const BonePose& a, const BonePose& b, double s);

/// The hip as particles: acetabular nodes, femoral nodes, and one for the femur's free translation
/// t.
///
/// Femoral nodes are stored without t (elasticity does not feel it); their true position is y + t.
/// So t is felt by contact, through its weight 1 in every femoral surface vertex, and by ligaments.
/// After t come points of the rigid femur where they are needed, stored like femoral nodes and
/// held: vertices of its surface that the socket's cartilage or the labrum may touch, the
/// ligaments' insertions, the joint centre. Last come the nodes of the soft labrum.
class HipSystem {
 public:
  /// @note keeps a reference to the model, which must outlive it
  explicit HipSystem(const JointModel& model);

  Index n_acetabular() const { return n_acetabular_; }
  Index n_femoral() const { return n_femoral_; }
  Index translation() const { return n_acetabular_ + n_femoral_; }  ///< its particle
  Index n_particles() const { return first_labrum_node() + (labrum_ ? labrum_->n_nodes() : 0); }
  const Vec3& centre() const { return centre_; }

  VecX reference() const;  ///< positions in the image pose, t = 0
  /// Carries the femur from one pose to another, with its deformation; t stays.
  void update_pose(VecX& x, const BonePose& from, const BonePose& to) const;

  /// @param reach  how far the head may move, mm: bone farther than that is left out
  HipContact make_contact(double stiffness, double reach) const;
  /// Blocks of the elastic Jacobian: of cartilages, labrum and ligaments.
  std::vector<std::pair<Index, Index>> elastic_pattern() const;
  /// Adds it at x, but for the `patch_terms` of what resists volume change by patches,
  void add_elastic_jacobian(const VecX& x, solve::BlockMatrix& A) const;
  /// which is this.
  std::vector<const fem::MeanDilatation*> patches() const;
  /// Sum of all elastic forces at x on all particles, N; sets their energy, N·mm.
  VecX elastic_force(const VecX& x, double& energy) const;
  const fem::ElasticForce& socket_elasticity() const { return socket_elasticity_.by_element(); }
  const fem::ElasticForce& femur_elasticity() const { return femur_elasticity_.by_element(); }
  const std::optional<LigamentForce>& ligaments() const { return ligaments_; }
  const std::optional<LabrumBody>& labrum() const { return labrum_; }
  /// Particles that may move; t only when it is free.
  std::vector<bool> free_particles(LoadMode mode) const;
  /// Held nodes of the acetabular and of the femoral bone side.
  const std::vector<Index>& socket_nodes() const { return socket_nodes_; }
  const std::vector<Index>& femur_nodes() const { return femur_nodes_; }

  /// Confined modulus over the sum of both mean thicknesses, MPa/mm: what a millimetre of approach
  /// is worth.
  double foundation_stiffness() const { return foundation_stiffness_; }

 private:
  collide::SurfaceContact make_cartilage_contact(double stiffness) const;
  std::optional<collide::SurfaceContact> make_bone_contact(double stiffness, double reach) const;
  std::optional<collide::SurfaceContact> make_femur_contact(double stiffness) const;
  std::vector<collide::SurfaceContact> make_labrum_contacts(double stiffness) const;
  std::optional<collide::ContactFriction> make_friction(double stiffness) const;
  std::vector<const CartilageElasticity*> bodies() const;
  void add_bare_femur();
  void add_ligaments();
  Index first_femur_point() const { return translation() + 1; }
  Index first_labrum_node() const {
    return first_femur_point() + static_cast<Index>(femur_points_.rows());
  }

  const JointModel& model_;
  Index n_acetabular_, n_femoral_;
  Vec3 centre_;
  std::vector<Index> socket_nodes_, femur_nodes_;
  CartilageElasticity socket_elasticity_, femur_elasticity_;
  Points femur_points_ = Points(0, 3);  // in the image pose
  Triangles bare_femur_;                // of femur points
  std::optional<LigamentForce> ligaments_;
  std::optional<LabrumBody> labrum_;
  double foundation_stiffness_ = 0.0;
};

}  // namespace coxa::joint
