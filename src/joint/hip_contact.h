#pragma once

#include <coxa/collide/surface_contact.h>

#include <optional>

namespace coxa::joint {

/// Everything that touches in the hip: the articular surfaces each other, and the femoral one the
/// hip bone where no cartilage covers it.
class HipContact {
 public:
  /// @param cartilages  slave the acetabular articular side
  /// @param bone        slave the femoral articular side, obstacle the hip bone; nullopt: no bone
  HipContact(collide::SurfaceContact cartilages, std::optional<collide::SurfaceContact> bone)
      : cartilages_(std::move(cartilages)), bone_(std::move(bone)) {}

  const collide::SurfaceContact& cartilages() const { return cartilages_; }
  const std::optional<collide::SurfaceContact>& bone() const { return bone_; }

  /// As of `collide::SurfaceContact`, for both.
  void update_pairs(const VecX& x, double reach = kInfinity);
  void update_multipliers(const VecX& x, double tolerance);
  void clear_stiffening();
  void clear_multipliers();
  void update_stiffness(double stiffness);
  void add_force(const VecX& x, VecX& force) const;
  double energy(const VecX& x) const;

  /// Largest overlap as enforced, mm.
  double penetration(const VecX& x) const;
  /// Force of the femur on the socket, N: on its cartilage and on its bare bone.
  Vec3 force(const VecX& x) const { return force_on_cartilage(x) + force_on_bone(x); }
  Vec3 force_on_cartilage(const VecX& x) const;
  Vec3 force_on_bone(const VecX& x) const;

  /// Calls visit(contact, constraint) for every constraint, in a fixed order.
  template <class Visit>
  void for_each_constraint(const Visit& visit) const {
    for (const auto& constraint : cartilages_.constraints()) visit(cartilages_, constraint);
    if (!bone_) return;
    for (const auto& constraint : bone_->constraints()) visit(*bone_, constraint);
  }

 private:
  collide::SurfaceContact cartilages_;
  std::optional<collide::SurfaceContact> bone_;
};

}  // namespace coxa::joint
