#pragma once

#include <coxa/collide/surface_contact.h>

#include <optional>

namespace coxa::joint {

/// Everything that touches in the hip: the articular surfaces each other, and each the other side's
/// bone where no cartilage covers it.
class HipContact {
 public:
  /// @param cartilages  slave the acetabular articular side
  /// @param bone        slave the femoral articular side, obstacle the hip bone; nullopt: no bone
  /// @param femur       slave the acetabular articular side, other the femur; nullopt: none
  HipContact(collide::SurfaceContact cartilages, std::optional<collide::SurfaceContact> bone,
             std::optional<collide::SurfaceContact> femur)
      : cartilages_(std::move(cartilages)), bone_(std::move(bone)), femur_(std::move(femur)) {}

  const collide::SurfaceContact& cartilages() const { return cartilages_; }
  const std::optional<collide::SurfaceContact>& bone() const { return bone_; }
  const std::optional<collide::SurfaceContact>& femur() const { return femur_; }

  /// As of `collide::SurfaceContact`, for all.
  void update_pairs(const VecX& x, double reach = kInfinity, double slide = 1.0);
  void forget_clearances();
  void update_multipliers(const VecX& x, double tolerance);
  void clear_stiffening();
  void clear_multipliers();
  void update_stiffness(double stiffness);
  void add_force(const VecX& x, VecX& force) const;
  double energy(const VecX& x) const;

  /// Largest overlap as enforced, mm.
  double penetration(const VecX& x) const;
  /// Force of the femur on the socket, N: on its cartilage, on its bare bone, and by bare femur.
  Vec3 force(const VecX& x) const;
  Vec3 force_on_cartilage(const VecX& x) const;
  Vec3 force_on_bone(const VecX& x) const;
  Vec3 force_of_femur(const VecX& x) const;

  /// Calls visit(contact, constraint) for every constraint, in a fixed order.
  template <class Visit>
  void for_each_constraint(const Visit& visit) const {
    for_each(*this, [&](const collide::SurfaceContact& contact) {
      for (const auto& constraint : contact.constraints()) visit(contact, constraint);
    });
  }

 private:
  template <class Self, class Visit>
  static void for_each(Self& self, const Visit& visit) {
    visit(self.cartilages_);
    if (self.bone_) visit(*self.bone_);
    if (self.femur_) visit(*self.femur_);
  }

  collide::SurfaceContact cartilages_;
  std::optional<collide::SurfaceContact> bone_, femur_;
};

}  // namespace coxa::joint
