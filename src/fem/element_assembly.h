#pragma once

#include <coxa/core/parallel.h>
#include <coxa/fem/elastic_force.h>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "lanes.h"
#include "scatter.h"

namespace coxa::fem {

/// Elements on particles: deformation gradients in, nodal forces and matrix blocks out. Sums run
/// particle by particle in the order of the elements, so they do not depend on the number of
/// threads.
class ElementAssembly {
 public:
  ElementAssembly(const TetMesh& mesh, ParticleMap map, const std::vector<Mat3>& axes);

  Index n_elements() const { return n_elements_; }
  int n_points() const { return n_points_; }
  /// Number of integration point q of element e among all, and how many there are.
  std::size_t point(Index e, int q) const {
    return static_cast<std::size_t>(e) * static_cast<std::size_t>(n_points_) +
           static_cast<std::size_t>(q);
  }
  std::size_t n_all_points() const { return weight_.size(); }
  /// Reference volume of integration point q of element e.
  double weight(Index e, int q) const { return weight_[point(e, q)]; }
  int n_nodes() const { return n_nodes_; }
  Index particle(Index e, int a) const { return scatter_.particle(corner(e, a)); }
  /// dN_a/dX at integration point q of element e, material axes, 1/mm.
  const Vec3& shape_gradient(Index e, int q, int a) const {
    return shape_gradient_[point(e, q) * static_cast<std::size_t>(n_nodes_) +
                           static_cast<std::size_t>(a)];
  }
  std::vector<std::pair<Index, Index>> pattern() const { return scatter_.pattern(); }
  void set_offsets(const Points& offset);
  Points node_positions(const VecX& x) const;

  /// Deformation gradient in material axes.
  Mat3 gradient_of(const VecX& x, Index e, int q) const {
    Mat3 F = Mat3::Zero();
    for (int a = 0; a < n_nodes_; ++a) {
      const std::size_t k = corner(e, a);
      const Vec3 position =
          x.segment<3>(3 * Eigen::Index{scatter_.particle(k)}) + offset_.row(node_[k]).transpose();
      F += position * shape_gradient(e, q, a).transpose();
    }
    return F;
  }
  /// Its rate of change at velocities v.
  Mat3 rate_of(const VecX& v, Index e, int q) const {
    Mat3 rate = Mat3::Zero();
    for (int a = 0; a < n_nodes_; ++a)
      rate += v.segment<3>(3 * Eigen::Index{scatter_.particle(corner(e, a))}) *
              shape_gradient(e, q, a).transpose();
    return rate;
  }

  /// Adds -weight P r to each node, P = first_piola(e, q).
  template <class FirstPiola>
  void add_force(const FirstPiola& first_piola, VecX& force) const {
    part_.resize(node_.size());
    Vec3* part = part_.data();
    parallel_for(n_elements_, [&](Index e) {
      for (int a = 0; a < n_nodes_; ++a) part[corner(e, a)].setZero();
      for (int q = 0; q < n_points_; ++q) {
        const Mat3 P = weight(e, q) * first_piola(e, q);
        for (int a = 0; a < n_nodes_; ++a) part[corner(e, a)] -= P * shape_gradient(e, q, a);
      }
    });
    scatter_.gather_force(part, force);
  }

  /// Four four-node elements as they are at x; where their forces go is the caller's.
  struct LanePositions {
    Vec3 of[kLanes][4];
  };
  LaneElements lane_elements(const VecX& x, const Index (&element)[kLanes],
                             LanePositions& positions) const;
  /// Adds the forces of four-node elements, four at a time, and returns the sum of their energies.
  double add_force_in_lanes(const Material& material, const VecX& x, VecX& force) const;

  /// Gradients of the shape functions at point q of element e.
  std::span<const Vec3> shape_gradients(Index e, int q) const {
    return {&shape_gradient_[point(e, q) * static_cast<std::size_t>(n_nodes_)],
            static_cast<std::size_t>(n_nodes_)};
  }
  /// Adds what add_blocks(e, q, weight, blocks) adds to the blocks of each element.
  template <class AddBlocks>
  void add_jacobian(const AddBlocks& add_blocks, solve::BlockMatrix& A) const {
    blocks_.resize(scatter_.n_blocks());
    parallel_for(n_elements_, [&](Index e) {
      Mat3* blocks = &blocks_[scatter_.block(e)];
      std::fill_n(blocks, n_nodes_ * (n_nodes_ + 1) / 2, Mat3::Zero());
      for (int q = 0; q < n_points_; ++q) add_blocks(e, q, weight(e, q), blocks);
    });
    scatter_.gather_blocks(blocks_.data(), A);
  }

  /// Sum of weight * density(e, q).
  template <class Density>
  double sum(const Density& density) const {
    return parallel_reduce(
        n_elements_, 0.0,
        [&](Index e) {
          double total = 0.0;
          for (int q = 0; q < n_points_; ++q) total += weight(e, q) * density(e, q);
          return total;
        },
        [](double a, double b) { return a + b; });
  }

 private:
  std::size_t corner(Index e, int a) const {
    return static_cast<std::size_t>(e) * static_cast<std::size_t>(n_nodes_) +
           static_cast<std::size_t>(a);
  }

  Index n_elements_ = 0;
  int n_nodes_ = 4, n_points_ = 1;
  std::vector<Index> node_;           // M × n_nodes
  std::vector<double> weight_;        // M × n_points
  std::vector<Vec3> shape_gradient_;  // M × n_points × n_nodes, material axes, 1/mm
  Points offset_;                     // N × 3
  Scatter scatter_;                   // elements to particles
  // of the elements, kept for the next call
  mutable std::vector<Mat3> blocks_;
  mutable std::vector<Vec3> part_;
};

}  // namespace coxa::fem
