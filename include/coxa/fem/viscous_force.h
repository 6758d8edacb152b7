#pragma once

#include <coxa/fem/curve_material.h>
#include <coxa/fem/elastic_force.h>

namespace coxa::fem {

/// Viscosity by curves of the strain rate: S is the sum of stress_k(direction_k . rate)
/// direction_k, where the rate is that of the Green strain along the material axes, 1/s.
///
/// @note its Jacobian by velocities is exact; by positions it holds the symmetric part that turns
/// with the element
///       (dF S), not the change of the rate with the positions, which is not symmetric.
class ViscousForce : public dynamics::Force {
 public:
  /// @throws Error bad_mesh for an element of no positive volume, bad_input without modes
  ViscousForce(const TetMesh& mesh, const std::vector<StrainMode>& modes, ParticleMap map = {},
               const std::vector<Mat3>& axes = {});
  ~ViscousForce() override;

  std::vector<std::pair<Index, Index>> pattern() const override;
  void add_force(const VecX& x, const VecX& v, VecX& force) const override;
  void add_jacobian(const VecX& x, const VecX& v, double stiffness_factor, double damping_factor,
                    solve::BlockMatrix& A) const override;
  /// 0: nothing is stored.
  double energy(const VecX&) const override { return 0.0; }

  void set_offsets(const Points& offset);
  /// Power turned into heat, N·mm/s.
  double dissipation(const VecX& x, const VecX& v) const;

 private:
  Mat3 second_piola(const Mat3& F, const Mat3& rate) const;
  std::vector<Curve> curves_;
  std::vector<Mat3> tensors_;
  std::unique_ptr<ElementAssembly> assembly_;
};

}  // namespace coxa::fem
