#pragma once

#include <coxa/dynamics/particles.h>

namespace coxa::dynamics {

/// Blocks that the Jacobians of any of the forces may fill.
std::vector<std::pair<Index, Index>> total_pattern(const std::vector<const Force*>& forces);

/// Sum of the forces at (x, v), 3n values, N.
VecX total_force(const std::vector<const Force*>& forces, const VecX& x, const VecX& v);

/// Sum of the energies, N·mm; NaN where one force has none.
double total_energy(const std::vector<const Force*>& forces, const VecX& x);

/// A = stiffness_factor * (-df/dx) + damping_factor * (-df/dv), summed over the forces.
void assemble(const std::vector<const Force*>& forces, const VecX& x, const VecX& v,
              double stiffness_factor, double damping_factor, solve::BlockMatrix& A);

/// m |v|^2 / 2 summed over the particles, N·mm.
double kinetic_energy(const Particles& particles);

/// Replaces A by S A S + (I - S) s, where S is the constraints' projector and s a typical diagonal:
/// a direct solve with a filtered right side then stays in the allowed directions.
void update_constrained(const Constraints& constraints, solve::BlockMatrix& A);

/// @throws Error bad_input if x, v and mass disagree in length or a mass is not positive and finite
void check(const Particles& particles);

}  // namespace coxa::dynamics
