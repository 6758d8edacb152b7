#include "hip_contact.h"

#include <algorithm>

namespace coxa::joint {
namespace {

/// Sum of pressure times area times normal over the constraints: force of the other body on the
/// slave, N.
Vec3 force_on_slave(const collide::SurfaceContact& contact, const VecX& x) {
  Vec3 sum = Vec3::Zero();
  for (const collide::ContactConstraint& constraint : contact.constraints()) {
    sum += contact.pressure(constraint, x) * constraint.area * constraint.normal;
  }
  return sum;
}

}  // namespace

void HipContact::update_pairs(const VecX& x, double reach) {
  cartilages_.update_pairs(x, reach);
  if (bone_) bone_->update_pairs(x, reach);
}

void HipContact::update_multipliers(const VecX& x, double tolerance) {
  cartilages_.update_multipliers(x, tolerance);
  if (bone_) bone_->update_multipliers(x, tolerance);
}

void HipContact::clear_stiffening() {
  cartilages_.clear_stiffening();
  if (bone_) bone_->clear_stiffening();
}

void HipContact::clear_multipliers() {
  cartilages_.clear_multipliers();
  if (bone_) bone_->clear_multipliers();
}

void HipContact::update_stiffness(double stiffness) {
  cartilages_.update_stiffness(stiffness);
  if (bone_) bone_->update_stiffness(stiffness);
}

void HipContact::add_force(const VecX& x, VecX& force) const {
  cartilages_.add_force(x, VecX(), force);
  if (bone_) bone_->add_force(x, VecX(), force);
}

double HipContact::energy(const VecX& x) const {
  return cartilages_.energy(x) + (bone_ ? bone_->energy(x) : 0.0);
}

double HipContact::penetration(const VecX& x) const {
  double deepest = 0.0;
  for_each_constraint([&](const auto& contact, const auto& constraint) {
    deepest = std::max(deepest, -contact.gap(constraint, x));
  });
  return deepest;
}

Vec3 HipContact::force_on_cartilage(const VecX& x) const { return force_on_slave(cartilages_, x); }

Vec3 HipContact::force_on_bone(const VecX& x) const {
  return bone_ ? Vec3(-force_on_slave(*bone_, x)) : Vec3(Vec3::Zero());
}

}  // namespace coxa::joint
