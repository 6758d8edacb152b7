#pragma once

#include <coxa/fem/elastic_force.h>

namespace coxa::fem {

/// One term of a Prony series.
struct PronyTerm {
  double share = 0.0;  ///< of the instantaneous stiffness that relaxes, in (0, 1)
  double time = 1.0;   ///< s, > 0
};

/// Elastic force whose second Piola-Kirchhoff stress relaxes by a Prony series (quasi-linear
/// viscoelasticity); the material is the instantaneous response, 1 - sum of shares of it remains.
///
/// The recurrence is exact where the elastic stress changes linearly over a step. For each step:
/// begin_step(h), then move the particles (relaxation, or a step of backward Euler, whose forces
/// act at the end of the step), then end_step. Source: Simo and Hughes 1998, section 10.3; Soussou,
/// Moavenzadeh and Gradowczyk 1970.
class ViscoelasticForce : public dynamics::Force {
 public:
  /// @throws Error bad_mesh, or bad_input for shares that sum to more than 1 or options that do not
  /// fit
  ViscoelasticForce(const TetMesh& mesh, std::unique_ptr<const Material> material,
                    std::vector<PronyTerm> terms, ParticleMap map = {},
                    ElasticOptions options = {});
  ~ViscoelasticForce() override;

  /// Prepares for a step of h seconds, h >= 0.
  void begin_step(double h);
  /// Takes x as the end of the step begun last.
  void end_step(const VecX& x);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  /// Potential of the step begun last, whose gradient is the force; not the stored energy.
  double energy(const VecX& x) const override;

  void set_offsets(const Points& offset);
  /// Cauchy stress of element e at the end x of the step begun last, MPa, world axes.
  Mat3 cauchy_stress(const VecX& x, Index e) const;

 private:
  struct State;
  Mat3 first_piola(const Mat3& F, Index e, int q) const;

  std::unique_ptr<const Material> material_;
  std::vector<PronyTerm> terms_;
  Tangent tangent_;
  std::unique_ptr<ElementAssembly> assembly_;
  std::unique_ptr<State> state_;
};

}  // namespace coxa::fem
