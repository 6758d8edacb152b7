#pragma once

#include <coxa/collide/contact_friction.h>
#include <coxa/collide/surface_contact.h>

#include <optional>
#include <vector>

namespace coxa::joint {

/// Everything that touches in the hip: the articular surfaces each other, each the other side's
/// bone where no cartilage covers it, and the femur the labrum.
class HipContact {
 public:
  /// @param cartilages  slave the acetabular articular side
  /// @param bone        slave the femoral articular side, obstacle the hip bone; nullopt: no bone
  /// @param femur       slave the acetabular articular side, other the femur; nullopt: none
  /// @param labrum      slaves the soft labrum, others what of the femur it touches
  /// @param friction    between the cartilages; nullopt: none
  HipContact(collide::SurfaceContact cartilages, std::optional<collide::SurfaceContact> bone,
             std::optional<collide::SurfaceContact> femur,
             std::vector<collide::SurfaceContact> labrum,
             std::optional<collide::ContactFriction> friction)
      : cartilages_(std::move(cartilages)),
        bone_(std::move(bone)),
        femur_(std::move(femur)),
        labrum_(std::move(labrum)),
        friction_(std::move(friction)) {}

  const collide::SurfaceContact& cartilages() const { return cartilages_; }
  const std::optional<collide::SurfaceContact>& bone() const { return bone_; }
  const std::optional<collide::SurfaceContact>& femur() const { return femur_; }

  const std::optional<collide::ContactFriction>& friction() const { return friction_; }

  /// Slip counts from positions x on, with the tractions that friction has there.
  void begin_slip(const VecX& x);
  /// As if nothing had slipped yet: for a head that has just been seated.
  void forget_slip();
  /// As of `collide::SurfaceContact`, for all; friction is limited by the pressures at x.
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
  /// Force of the femur on the socket, N: on its cartilage, on its bare bone, by bare femur, and on
  /// the labrum.
  Vec3 force(const VecX& x) const;
  Vec3 force_on_cartilage(const VecX& x) const;
  Vec3 force_on_bone(const VecX& x) const;
  Vec3 force_of_femur(const VecX& x) const;
  Vec3 force_on_labrum(const VecX& x) const;
  Vec3 friction_force(const VecX& x) const;  ///< part of that on cartilage

  /// Calls visit(contact, constraint) for every constraint, in a fixed order.
  template <class Visit>
  void for_each_constraint(const Visit& visit) const {
    for_each(*this, [&](const collide::SurfaceContact& contact) {
      for (const auto& constraint : contact.constraints()) visit(contact, constraint);
    });
  }
  /// Likewise for those that seat the head: all but the labrum's, which gives way.
  template <class Visit>
  void for_each_firm_constraint(const Visit& visit) const {
    for_each_firm(*this, [&](const collide::SurfaceContact& contact) {
      for (const auto& constraint : contact.constraints()) visit(contact, constraint);
    });
  }
  /// Calls visit(contact) for the contacts of the labrum.
  template <class Visit>
  void for_each_labrum(const Visit& visit) const {
    for (const collide::SurfaceContact& contact : labrum_) visit(contact);
  }

 private:
  template <class Self, class Visit>
  static void for_each_firm(Self& self, const Visit& visit) {
    visit(self.cartilages_);
    if (self.bone_) visit(*self.bone_);
    if (self.femur_) visit(*self.femur_);
  }
  template <class Self, class Visit>
  static void for_each(Self& self, const Visit& visit) {
    for_each_firm(self, visit);
    for (auto& contact : self.labrum_) visit(contact);
  }

  collide::SurfaceContact cartilages_;
  std::optional<collide::SurfaceContact> bone_, femur_;
  std::vector<collide::SurfaceContact> labrum_;
  std::optional<collide::ContactFriction> friction_;
};

}  // namespace coxa::joint
