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

void HipContact::begin_slip(const VecX& x) {
  if (!friction_) return;
  friction_->end_step(x);
  friction_->begin_step(x);
}

void HipContact::forget_slip() {
  if (friction_) friction_->forget();
}

void HipContact::update_pairs(const VecX& x, double reach, double slide) {
  for_each(*this, [&](collide::SurfaceContact& contact) { contact.update_pairs(x, reach, slide); });
  if (friction_) friction_->update(cartilages_, x);
}

void HipContact::forget_clearances() {
  for_each(*this, [](collide::SurfaceContact& contact) { contact.forget_clearances(); });
}

void HipContact::update_multipliers(const VecX& x, double tolerance) {
  for_each(*this,
           [&](collide::SurfaceContact& contact) { contact.update_multipliers(x, tolerance); });
}

void HipContact::clear_stiffening() {
  for_each(*this, [](collide::SurfaceContact& contact) { contact.clear_stiffening(); });
}

void HipContact::clear_multipliers() {
  for_each(*this, [](collide::SurfaceContact& contact) { contact.clear_multipliers(); });
}

void HipContact::update_stiffness(double stiffness) {
  for_each(*this, [&](collide::SurfaceContact& contact) { contact.update_stiffness(stiffness); });
}

void HipContact::add_force(const VecX& x, VecX& force) const {
  for_each(*this,
           [&](const collide::SurfaceContact& contact) { contact.add_force(x, VecX(), force); });
  if (friction_) friction_->add_force(x, VecX(), force);
}

double HipContact::energy(const VecX& x) const {
  double sum = 0.0;
  for_each(*this, [&](const collide::SurfaceContact& contact) { sum += contact.energy(x); });
  return friction_ ? sum + friction_->energy(x) : sum;
}

double HipContact::penetration(const VecX& x) const {
  double deepest = 0.0;
  for_each_constraint([&](const auto& contact, const auto& constraint) {
    deepest = std::max(deepest, -contact.gap(constraint, x));
  });
  return deepest;
}

Vec3 HipContact::force(const VecX& x) const {
  return force_on_cartilage(x) + force_on_bone(x) + force_of_femur(x) + force_on_labrum(x);
}

Vec3 HipContact::force_on_cartilage(const VecX& x) const {
  return force_on_slave(cartilages_, x) + friction_force(x);
}

Vec3 HipContact::friction_force(const VecX& x) const {
  return friction_ ? friction_->resultant(x) : Vec3(Vec3::Zero());
}

Vec3 HipContact::force_on_bone(const VecX& x) const {
  return bone_ ? Vec3(-force_on_slave(*bone_, x)) : Vec3(Vec3::Zero());
}

Vec3 HipContact::force_on_labrum(const VecX& x) const {
  Vec3 sum = Vec3::Zero();
  for (const collide::SurfaceContact& contact : labrum_) sum += force_on_slave(contact, x);
  return sum;
}

Vec3 HipContact::force_of_femur(const VecX& x) const {
  return femur_ ? force_on_slave(*femur_, x) : Vec3(Vec3::Zero());
}

}  // namespace coxa::joint
