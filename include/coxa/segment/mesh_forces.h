#pragma once

#include <coxa/dynamics/particles.h>
#include <coxa/mesh/simplex_mesh.h>

namespace coxa::segment {

/// Springs from particles [first, first + count) to targets, stiffer along a direction than across
/// it.
class TargetForce : public dynamics::Force {
 public:
  explicit TargetForce(Index first) : first_(first) {}
  /// @param targets n×3, mm   @param stiffness n, >= 0   @param normals n×3 unit
  /// @param tangential share of the stiffness that acts across the normal, in [0, 1]
  void prepare(Points targets, const VecX& stiffness, const Points& normals, double tangential);

  std::vector<std::pair<Index, Index>> pattern() const override { return {}; }
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

 private:
  Index first_;
  Points targets_;
  std::vector<Mat3> stiffness_;
};

/// Pulls every vertex of a simplex mesh, with its neighbours, towards the local form asked for:
/// energy (stiffness / 2) sum |P - e1 A - e2 B - e3 C - offset|², the offset along the normal held
/// since `prepare`.
///
/// Source: Delingette 1999, with the force taken from an energy so that implicit steps have a
/// symmetric matrix.
class SimplexForce : public dynamics::Force {
 public:
  /// @param first particle of vertex 0
  SimplexForce(Index first, Triangles neighbours);
  /// @param offsets V×3, mm: height times normal   @param metric V×3, e1 e2 e3   @param stiffness
  /// >= 0
  void prepare(Points metric, Points offsets, double stiffness);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

 private:
  Vec3 residual(const VecX& x, Index vertex) const;
  Index first_;
  Triangles neighbours_;
  Points metric_, offsets_;
  double stiffness_ = 0.0;
};

/// Position of a vertex over neighbours A, B, C with metric parameters e and simplex angle phi;
/// falls back to `height` (mm) where the foot lies outside the circumscribed circle and the angle
/// does not determine it. Source: Delingette 1999 eq. for L(r, d, phi), with the sign of the root
/// for |phi| > pi/2 corrected.
Vec3 position_from_angle(const Vec3& metric, double phi, double height, const Vec3& A,
                         const Vec3& B, const Vec3& C);

}  // namespace coxa::segment
