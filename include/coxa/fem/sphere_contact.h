#pragma once

#include <coxa/dynamics/particles.h>

#include <vector>

namespace coxa::fem {

/// A rigid, frictionless sphere.
struct RigidSphere {
  Vec3 centre = Vec3::Zero();  ///< mm
  double radius = 1.0;         ///< mm, > 0
};

/// Nodes of the surface triangles that may touch: three corners, then the middles of 01, 12, 20 for
/// curved ones.
using ContactFaces = Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Penalty contact of a deformable surface with a rigid sphere from outside: energy k/2 times the
/// integral of the squared penetration over the reference area, so that pressure k * penetration
/// does not depend on the mesh.
///
/// Source: Hirota et al. 2001 (area-weighted penalty), here with seven-point quadrature on each
/// face.
class SphereContact : public dynamics::Force {
 public:
  /// @param faces F×3 or F×6 particles   @param rest 3n reference positions, mm   @param stiffness
  /// MPa/mm, > 0
  /// @throws Error bad_input for another number of columns or a stiffness or radius that is not
  /// positive
  SphereContact(ContactFaces faces, const VecX& rest, const RigidSphere& sphere, double stiffness);

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  double energy(const VecX& x) const override;

  void set_sphere(const RigidSphere& sphere) { sphere_ = sphere; }
  /// Force that the surface takes from the sphere, N.
  Vec3 resultant(const VecX& x) const;
  /// Pressure where the surface is at `position`, MPa.
  double pressure_at(const Vec3& position) const;

 private:
  struct Point {
    Vec3 position, normal;  // normal: out of the sphere
    double gap;             // mm, negative inside
  };
  Point point(const VecX& x, Index face, int q) const;

  ContactFaces faces_;
  RigidSphere sphere_;
  double stiffness_;
  std::vector<double> weight_;  // F × 7, mm²
  MatX shape_;                  // 7 × nodes of a face
};

}  // namespace coxa::fem
