#pragma once

#include <coxa/collide/surface_contact.h>

namespace coxa::collide {

/// Coulomb friction at the constraints of a SurfaceContact, in increments: a tangential traction
/// that grows with the slip since the step began, stiffly, up to the coefficient times the
/// pressure.
///
/// The pressure that limits it is the one of the last `update`, so that within a step friction has
/// an energy, which is convex; repeat `update` and the solve until nothing changes.
/// @note keeps a reference to the contact, which must outlive it; the pattern changes with the
///       contact's pairs; bit-identical for any number of threads
/// Source: Coulomb's law with a tangential penalty and radial return; Wriggers, Computational
/// Contact Mechanics.
class ContactFriction : public dynamics::Force {
 public:
  /// @param coefficient  of friction, >= 0
  /// @param stiffness    MPa/mm, > 0: traction for a millimetre of slip before it slides
  ContactFriction(const SurfaceContact& contact, double coefficient, double stiffness);

  /// Starts a step at positions x: slip counts from here, with the tractions that were left.
  void begin_step(const VecX& x);
  /// Takes the contact's constraints and their pressures at x.
  void update(const VecX& x);
  /// Keeps the tractions at x, for the step that follows.
  void end_step(const VecX& x);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  /// Sum of the tangential forces on the slave surface at x, N.
  Vec3 resultant(const VecX& x) const;

 private:
  /// A constraint's tangential side: slip = tangent sum weight[k] (x - start)[particle[k]].
  struct Patch {
    Index owner, first, last;  // range in weights_ and in the contact's stencil
    Mat3 tangent;              // projector
    double area, limit;        // mm², MPa
    Vec3 traction;             // left from the step before, turned into the tangent plane
  };
  Vec3 trial(const Patch& patch, const VecX& x) const;
  Vec3 traction(const Patch& patch, const VecX& x) const;

  const SurfaceContact& contact_;
  double coefficient_, stiffness_;
  VecX start_;
  std::vector<Vec3> left_;  // per owner, MPa
  std::vector<Patch> patches_;
  std::vector<Index> particles_;
  std::vector<double> weights_;
};

}  // namespace coxa::collide
