#pragma once

#include <coxa/fem/elastic_force.h>
#include <coxa/fem/mean_dilatation.h>
#include <coxa/joint/joint_model.h>

#include <memory>
#include <vector>

namespace coxa::joint {

/// Elastic forces of a cartilage whose node i is particle first_particle + i; the Jacobian is
/// positive semidefinite where the law's own is not, so that Newton steps go downhill.
class CartilageElasticity {
 public:
  CartilageElasticity(const TetMesh& mesh, Index first_particle, const CartilageMaterial& material);

  /// Adds the forces and returns the energy, N·mm; infinite where the law forbids x.
  double add_force_with_energy(const VecX& x, VecX& force) const;
  /// Adds the part of the Jacobian that couples the nodes of single elements; the rest is the
  /// `patch_terms` of by_patch.
  void add_element_jacobian(const VecX& x, solve::BlockMatrix& A) const;
  /// What resists volume change by patches; null: nothing does.
  const fem::MeanDilatation* by_patch() const { return by_patch_.get(); }
  /// The law without what acts by patches: strains come from here.
  const fem::ElasticForce& by_element() const { return *by_element_; }
  /// Adds what the patches add to the elements' Cauchy stress, MPa.
  void add_patch_stress(const VecX& x, std::vector<Mat3>& cauchy_stress) const;

 private:
  std::unique_ptr<fem::ElasticForce> by_element_;
  std::unique_ptr<fem::MeanDilatation> by_patch_;  ///< null: none
};

}  // namespace coxa::joint
