#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/fem/material.h>
#include <coxa/mesh/tet_mesh.h>

#include <memory>
#include <vector>

namespace coxa::fem {

class ElementAssembly;

/// How the nodes of a mesh are tied to particles: node i is at x[particle_of[i]] + offset[i].
///
/// Several nodes may share a particle: they then move as one rigid translation (cartilage on a
/// bone).
struct ParticleMap {
  std::vector<Index> particle_of = {};  ///< N; empty: node i is particle i
  Points offset = {};                   ///< N×3, mm; empty: zero
};

struct ElasticOptions {
  std::vector<Mat3> axes =
      {};  ///< M, columns u, v, w of the material, orthonormal; empty: world axes
  Tangent tangent = Tangent::exact;  ///< what add_jacobian gives
};

/// Elastic force of a tetrahedral mesh: four-node elements in particle form (Volino,
/// Magnenat-Thalmann and Faure 2009 in three dimensions), or ten-node elements with four
/// integration points where the mesh has mid nodes.
///
/// @note keeps copies, no reference; cost O(M); bit-identical for any number of threads.
class ElasticForce : public dynamics::Force {
 public:
  /// @param mesh  reference shape
  /// @throws Error bad_mesh for an element of no positive volume, bad_input for options that do not
  /// fit the mesh
  ElasticForce(const TetMesh& mesh, std::unique_ptr<const Material> material, ParticleMap map = {},
               ElasticOptions options = {});
  ~ElasticForce() override;

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;
  /// Adds the force and returns the energy, for little more than the force alone costs.
  double add_force_with_energy(const VecX& x, VecX& force) const;

  /// Replaces the offsets of the nodes, for the next pose of a bone; N×3, mm.
  void set_offsets(const Points& offset);
  /// Where the nodes are, N×3, mm.
  Points node_positions(const VecX& x) const;
  /// Reference volume of each element, M values, mm³.
  VecX volumes() const;
  Index n_elements() const;
  const Material& material() const { return *material_; }

  /// Deformation gradient of element e at x, in world axes, averaged over its integration points.
  Mat3 deformation_gradient(const VecX& x, Index e) const;
  /// Cauchy stress of element e at x, MPa, world axes, averaged over its integration points.
  Mat3 cauchy_stress(const VecX& x, Index e) const;

 private:
  std::unique_ptr<const Material> material_;
  Tangent tangent_;
  std::vector<Mat3> axes_;
  std::unique_ptr<ElementAssembly> assembly_;
};

/// Mass of each particle: the mesh's mass lumped to its nodes and summed by particle (ten-node
/// elements: 1/36 of an element to a corner, 4/27 to a mid node; Hinton, Rock and Zienkiewicz
/// 1976).
/// @param density tonne/mm³   @returns n_particles values, tonne
VecX lumped_masses(const TetMesh& mesh, double density, Index n_particles,
                   const ParticleMap& map = {});

}  // namespace coxa::fem
