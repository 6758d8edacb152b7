#pragma once

#include <coxa/core/types.h>
#include <coxa/solve/block_matrix.h>

#include <memory>
#include <utility>
#include <vector>

namespace coxa::dynamics {

/// Positions, velocities and lumped masses of n particles: the shared heart of segmentation and
/// mechanics.
struct Particles {
  VecX x;     ///< 3n, mm
  VecX v;     ///< 3n, mm/s
  VecX mass;  ///< n, tonne (segmentation: pseudo-units, one per particle)

  Index n() const { return static_cast<Index>(mass.size()); }
  auto position(Index i) const { return x.segment<3>(3 * i); }
};

/// A force on particles, with its Jacobians. Implementations are stateless with respect to the
/// solve: `prepare` may refresh what depends on positions slowly (contact pairs, image targets).
class Force {
 public:
  virtual ~Force() = default;
  /// Blocks (i, j) that this force's Jacobians may fill.
  virtual std::vector<std::pair<Index, Index>> pattern() const = 0;
  /// Adds the force at (x, v), 3n values, N.
  virtual void add_force(const VecX& x, const VecX& v, VecX& force) const = 0;
  /// Adds `stiffness_factor * (-df/dx)` and `damping_factor * (-df/dv)` to A; either factor may be
  /// 0, and then its part should cost nothing.
  virtual void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor,
                            double damping_factor, solve::BlockMatrix& A) const = 0;
  /// Energy, N·mm; NaN for a force that has none.
  virtual double energy(const VecX& x) const = 0;
};

/// Constraints by mass modification (Baraff and Witkin 1998): particle i moves only in the range of
/// `allowed[i]`, apart from its prescribed velocity change.
struct Constraints {
  std::vector<Index> particles;  ///< constrained particles, ascending
  std::vector<Mat3>
      allowed;  ///< projector per constrained particle: I - pp^T, I - pp^T - qq^T, or 0
  std::vector<Vec3> velocity_change;  ///< prescribed along the forbidden directions, mm/s

  void hold(Index particle) { add(particle, Mat3::Zero(), Vec3::Zero()); }
  /// A second constraint of the same particle replaces the first.
  void add(Index particle, const Mat3& projector, const Vec3& dv);
  /// Projects a 3n vector onto the allowed directions.
  void filter(VecX& values) const;
};

using ForceList = std::vector<std::unique_ptr<Force>>;

}  // namespace coxa::dynamics
