#pragma once

#include <coxa/collide/surface_contact.h>

#include <array>

namespace coxa::collide {

/// Coulomb friction at the constraints of a SurfaceContact, in increments: a tangential traction
/// that grows with the slip since the step began, stiffly, up to the coefficient times the
/// pressure.
///
/// The pressure that limits it is the one of the last `update`, so that within a step friction has
/// an energy, which is convex; repeat `update` and the solve until nothing changes.
/// @note a copy goes its own way from there; the pattern changes with the contact's pairs;
///       bit-identical for any number of threads
/// Source: Coulomb's law with a tangential penalty and radial return; Wriggers, Computational
/// Contact Mechanics.
class ContactFriction : public dynamics::Force {
 public:
  /// @param coefficient  of friction, >= 0
  /// @param stiffness    MPa/mm, > 0: traction for a millimetre of slip before it slides
  ContactFriction(double coefficient, double stiffness);

  /// Starts a step at positions x: slip counts from here, with the tractions that were left.
  void begin_step(const VecX& x);
  /// Takes the contact's constraints and their pressures at x; always of the same contact, or of
  /// copies of it.
  void update(const SurfaceContact& contact, const VecX& x);
  /// Forgets tractions and slip: the next step starts without.
  void forget();
  /// Keeps the tractions at x, for the step that follows.
  void end_step(const VecX& x);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  /// Calls visit(stiffness, particles, slopes, n) for terms stiffness slope slope^T that sum to the
  /// Jacobian at x: what iterative solvers need of it. N/mm
  template <class Visit>
  void for_each_term(const VecX& x, const Visit& visit) const {
    std::vector<Vec3> slope;
    for (const Patch& patch : patches_) {
      for (const Term& term : terms_of(patch, x)) {
        slope.clear();
        for (Index k = patch.first; k < patch.last; ++k)
          slope.push_back(weights_[static_cast<std::size_t>(k)] * term.direction);
        visit(term.stiffness, &particles_[static_cast<std::size_t>(patch.first)], slope.data(),
              patch.last - patch.first);
      }
    }
  }

  /// Sum of the tangential forces on the slave surface at x, N.
  Vec3 resultant(const VecX& x) const;

 private:
  /// A constraint's tangential side: slip = tangent sum weight[k] (x - start)[particle[k]].
  struct Patch {
    Index owner, first, last;  // range in weights_ and in the contact's stencil
    Vec3 normal;
    Mat3 tangent;        // projector
    double area, limit;  // mm², MPa
    Vec3 traction;       // left from the step before, turned into the tangent plane
  };
  struct Term {
    double stiffness;  // N/mm
    Vec3 direction;    // unit, tangential
  };
  std::array<Term, 2> terms_of(const Patch& patch, const VecX& x) const;
  Vec3 trial(const Patch& patch, const VecX& x) const;
  Vec3 traction(const Patch& patch, const VecX& x) const;

  double coefficient_, stiffness_;
  VecX start_;
  std::vector<Vec3> left_;  // per owner, MPa
  std::vector<Patch> patches_;
  std::vector<Index> particles_;
  std::vector<double> weights_;
};

}  // namespace coxa::collide
