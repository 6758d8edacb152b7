#pragma once

#include <coxa/fem/elastic_force.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace coxa::fem {

/// What a law takes for the change of volume, so that lambda/2 of its square is the volumetric part
/// of the law's energy.
enum class Dilatation {
  log_volume,   ///< ln J: the neo-Hookean law
  stretch_sum,  ///< sum of the principal stretches less 3: the corotational law
  green_trace   ///< trace of Green's strain: St-Venant-Kirchhoff's law
};

/// Rank-one terms of a stiffness matrix: term k acts on particle[i] by slope[i], i from start[k] up
/// to start[k + 1].
struct PatchTerms {
  std::vector<double> stiffness;  ///< N/mm^5: by the change of the patch's volume
  std::vector<std::int64_t> start;
  std::vector<Index> particle;
  std::vector<Vec3> slope;  ///< mm²
};

/// Volume change resisted patch by patch instead of point by point, so that (nearly) incompressible
/// tetrahedra do not lock: energy V lambda/2 theta^2 with theta the dilatation of a patch, from the
/// mean of J, of the stretches or of E over it, and V its volume.
///
/// Takes the place of the volumetric part of a law: beside it, give ElasticForce the same law
/// without that part (lambda = 0, or Veronda-Westmann's isochoric part for ln J). A homogeneous
/// deformation gives the same stress either way. One patch is one element of ten nodes, or the star
/// of a node for elements of four (`volume_patches`). Source: mean dilatation of Nagtegaal, Parks
/// and Rice 1974; patches as in de Souza Neto et al. 2005, here with an energy.
class MeanDilatation : public dynamics::Force {
 public:
  struct Options {
    Dilatation dilatation = Dilatation::log_volume;
    /// What add_jacobian gives; a positive one makes no difference to log_volume.
    Tangent tangent = Tangent::exact;
  };
  /// @param patch_of  patch of each element, 0 to n-1   @param lambda MPa, > 0
  /// @throws Error bad_input if they do not fit
  MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda,
                 ParticleMap map, const Options& options);
  MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda,
                 ParticleMap map = {})
      : MeanDilatation(mesh, patch_of, lambda, std::move(map), Options()) {}
  ~MeanDilatation() override;

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  /// Infinite where the law forbids a patch's deformation.
  double energy(const VecX& x) const override;
  /// Adds the force and returns the energy, for little more than the force alone costs.
  double add_force_with_energy(const VecX& x, VecX& force) const;
  /// Likewise with what the law beside it resists with by elements, in one pass over them: what
  /// both need is worked out once. World axes.
  double add_force_with_energy(const VecX& x, const Material& beside, VecX& force) const;

  /// The Jacobian in two parts, for iterative solvers: what couples the nodes of one element only,
  /// added to a matrix with the pattern of the elements,
  void add_element_jacobian(const VecX& x, solve::BlockMatrix& A) const;
  /// the same with the law beside it,
  void add_element_jacobian(const VecX& x, const Material& beside, solve::BlockMatrix& A) const;
  /// and a term stiffness * slope slope^T for each patch.
  PatchTerms patch_terms(const VecX& x) const;

  void set_offsets(const Points& offset);
  /// What the patches add to the Cauchy stress of each element, averaged over its integration
  /// points, MPa.
  std::vector<Mat3> cauchy_stress(const VecX& x) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Patches for MeanDilatation: each element its own where it has ten nodes; for four-node elements
/// the stars of nodes that share no element, left-over elements joining a neighbour.
/// @returns M patch numbers from 0 without gaps; the same for the same mesh
std::vector<Index> volume_patches(const TetMesh& mesh);

}  // namespace coxa::fem
