#pragma once

#include <coxa/fem/elastic_force.h>

namespace coxa::fem {

/// Volume change resisted patch by patch instead of point by point, so that nearly incompressible
/// tetrahedra do not lock: energy V lambda/2 (ln J)^2 with J the volume ratio of a patch and V its
/// volume.
///
/// Takes the place of the volumetric part of a law: beside it, give ElasticForce the same law
/// without that part (neo-Hookean with lambda = 0, or Veronda-Westmann's isochoric part). A
/// homogeneous deformation gives the same stress either way. One patch is one element of ten nodes,
/// or the star of a node for elements of four
/// (`volume_patches`). Source: mean dilatation of Nagtegaal, Parks and Rice 1974; patches as in de
/// Souza Neto et al. 2005, here with an energy.
class MeanDilatation : public dynamics::Force {
 public:
  /// @param patch_of  patch of each element, 0 to n-1   @param lambda MPa, > 0
  /// @throws Error bad_input if they do not fit
  MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda,
                 ParticleMap map = {});
  ~MeanDilatation() override;

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  /// Infinite where a patch has no positive volume.
  double energy(const VecX& x) const override;

  void set_offsets(const Points& offset);
  /// What the patches add to the Cauchy stress of each element: this times the identity, MPa,
  /// tension positive.
  VecX mean_stress(const VecX& x) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Patches for MeanDilatation: each element its own where it has ten nodes; for four-node elements
/// the stars of nodes that share no element, left-over elements joining a neighbour.
/// @returns M patch numbers from 0 without gaps; the same for the same mesh
std::vector<Index> volume_patches(const TetMesh& mesh);

}  // namespace coxa::fem
