#pragma once

#include <coxa/core/solve_report.h>
#include <coxa/dynamics/particles.h>
#include <coxa/solve/block_matrix.h>

#include <vector>

#include "hip_system.h"

namespace coxa::joint {

/// Tangent stiffness of the free particles: an assembled elastic part, and terms of rank one.
///
/// Contact changes its pattern at every search, so it is not assembled: a pair costs six blocks a
/// product. Nor is the volume of a patch of elements, which would couple all its nodes.
class HipTangent {
 public:
  /// @param free per particle: whether it may move
  HipTangent(std::vector<bool> free, const HipSystem& system);

  /// Takes the elastic stiffness at x.
  void update_elastic(const HipSystem& system, const VecX& x);
  /// Takes the constraints that press at x; to be called after update_elastic and whenever contact
  /// changed.
  void update_contact(const HipContact& contact, const VecX& x);

  /// Solves tangent · step = residual (3n values; both zero at held particles) by conjugate
  /// gradients. Stops early, with what is reached, where the tangent is not positive definite.
  SolveReport solve(const VecX& residual, double tolerance, VecX& step) const;

 private:
  /// Terms stiffness * slope slope^T, and their entries by particle, so that products gather in a
  /// fixed order.
  struct Terms {
    struct Row {
      double stiffness;   // of contact: penalty times area, N/mm
      Index first, last;  // range in particle and slope
    };
    std::vector<Row> rows;
    std::vector<Index> particle;  // free numbers
    std::vector<Vec3> slope;
    std::vector<Index> use_start;  // per free particle: its uses by rows
    std::vector<Index> use_row;
    std::vector<Vec3> use_slope;
    mutable std::vector<double> row_force;  // scratch of update_forces

    void clear();
    void index_by_particle(std::size_t n_free);
    void add_diagonal(std::size_t free, Mat3& block) const;
    void update_forces(const VecX& z) const;
    /// Of the terms at the z of update_forces.
    Vec3 force(std::size_t free) const;
  };
  void add_row(Terms& terms, double stiffness, const Index* particle, const Vec3* slope,
               Index n) const;
  void update_preconditioner();
  void multiply(const VecX& z, VecX& y) const;
  VecX preconditioned(const VecX& r) const;

  std::vector<bool> free_;
  std::vector<Index> compact_;   // per particle its free number; meaningless where held
  std::vector<Index> particle_;  // per free number its particle
  solve::BlockMatrix full_, elastic_;
  std::vector<std::int64_t> source_;  // slot in full_ for every slot of elastic_

  Terms patches_, contact_;
  std::vector<Mat3> inverse_diagonal_;
};

}  // namespace coxa::joint
