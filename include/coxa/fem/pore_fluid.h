#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/mesh/tet_mesh.h>

#include <memory>
#include <vector>

namespace coxa::fem {

/// How easily the fluid goes through the solid, isotropic in the current shape:
/// k(J) = reference ((J - solid_share) / (1 - solid_share))^exponent exp(stiffening (J² - 1) / 2).
/// Source: Holmes and Mow 1990, eq. 9b.
struct Permeability {
  double reference = 1e-3;   ///< mm⁴/(N·s), > 0: at rest
  double solid_share = 0.0;  ///< in [0, 1), of the volume at rest; no fluid is left at J of so much
  double exponent = 0.0;     ///< >= 0
  double stiffening = 0.0;   ///< >= 0

  double at(double J) const;  ///< mm⁴/(N·s)
};

struct PoreFluidOptions {
  /// MPa/mm, > 0: pressure for a coordinate of 1 mm of a pressure particle. About a modulus over a
  /// length of the body makes the residuals of both kinds comparable.
  double pressure_unit = 1.0;
  /// 1/MPa, >= 0: resists pressures that are not constant over an element. Four-node elements need
  /// it, about 1 / (2 shear modulus); ten-node ones do not.
  double stabilisation = 0.0;
};

/// The fluid of a biphasic (porous) body: its pressure p and its flow through the solid.
///
/// Beside the forces of the solid (any of them) this makes the body biphasic: total stress is the
/// solid's minus p I, and the fluid that a part of the solid gives way to must flow off by Darcy's
/// law. Ten-node elements carry a pressure at each corner (Taylor and Hood), four-node ones as
/// well, stabilised. Finite strain; backward Euler in time, with the permeability of the step's
/// start, so that the force is the slope of a saddle function and its Jacobian symmetric.
///
/// Node i is particle i; the pressure of a corner node is the first coordinate of a particle of its
/// own after the nodes, in units of `pressure_unit`. Boundaries are sealed unless `add_drained` (or
/// a held pressure particle) says otherwise.
/// @note keeps copies; one call at a time per object; bit-identical for any number of threads
/// Source: Mow, Kuei, Lai and Armstrong 1980 (the theory); White and Borja 2008 (stabilisation).
class PoreFluid : public dynamics::Force {
 public:
  /// @throws Error bad_mesh for elements of no positive volume, bad_input for a value out of range
  /// or four-node elements without stabilisation
  PoreFluid(const TetMesh& mesh, const Permeability& permeability,
            const PoreFluidOptions& options = {});
  ~PoreFluid() override;

  Index n_particles() const;  ///< nodes, then pressures
  /// Particle of a corner node's pressure.
  /// @throws Error bad_input for a node that is no corner
  Index pressure_particle(Index node) const;
  /// Positions at rest and no pressure: 3 n_particles values.
  VecX reference() const;
  /// Holds what no pressure particle has: its second and third coordinate. To be called once.
  void add_unused(dynamics::Constraints& constraints) const;
  /// Holds the pressure of those of the nodes that are corners at what it is: open boundaries.
  void add_drained(const std::vector<Index>& nodes, dynamics::Constraints& constraints) const;

  /// Starts a step from x: volumes, permeabilities and pressures count from here.
  /// @param time_step  s, > 0
  void begin_step(const VecX& x, double time_step);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX&) const override { return kNaN; }

  /// Pressure at every node, MPa; at a node in the middle of an edge the mean of its ends.
  VecX pressure(const VecX& x) const;
  /// Fluid that has left through held pressures since the step began, mm³.
  double outflow(const VecX& x) const;
  /// Volume of the body at x, mm³.
  double volume(const VecX& x) const;
  /// Darcy's flow in each element, M×3, mm/s per current area, by the permeability of the step's
  /// start.
  Points flow(const VecX& x) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coxa::fem
