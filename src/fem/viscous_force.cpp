#include <coxa/fem/viscous_force.h>

#include <coxa/core/error.h>

#include "element_assembly.h"
#include "mode_tensors.h"
#include "point_blocks.h"

namespace coxa::fem {

ViscousForce::ViscousForce(const TetMesh& mesh, const std::vector<StrainMode>& modes,
                           ParticleMap map, const std::vector<Mat3>& axes)
    : assembly_(std::make_unique<ElementAssembly>(mesh, std::move(map), axes)) {
  require(!modes.empty(), "viscosity needs at least one mode");
  for (const StrainMode& mode : modes) {
    curves_.push_back(mode.stress);
    tensors_.push_back(mode_tensor(mode.direction));
  }
}

ViscousForce::~ViscousForce() = default;

std::vector<std::pair<Index, Index>> ViscousForce::pattern() const { return assembly_->pattern(); }

Mat3 ViscousForce::second_piola(const Mat3& F, const Mat3& rate) const {
  const Mat3 G = F.transpose() * rate;  // its symmetric part is the rate of the Green strain
  Mat3 S = Mat3::Zero();
  for (std::size_t k = 0; k < curves_.size(); ++k)
    S += curves_[k].value(tensors_[k].cwiseProduct(G).sum()) * tensors_[k];
  return S;
}

void ViscousForce::add_force(const VecX& x, const VecX& v, VecX& force) const {
  assembly_->add_force(
      [&](Index e, int q) {
        const Mat3 F = assembly_->gradient_of(x, e, q);
        return Mat3(F * second_piola(F, assembly_->rate_of(v, e, q)));
      },
      force);
}

void ViscousForce::add_jacobian(const VecX& x, const VecX& v, double stiffness_factor,
                                double damping_factor, solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0 && damping_factor == 0.0) return;
  assembly_->add_jacobian(
      [&](Index e, int q, double weight, Mat3* blocks) {
        const Mat3 F = assembly_->gradient_of(x, e, q), rate = assembly_->rate_of(v, e, q);
        const Mat3 G = F.transpose() * rate;
        Mat9 C = Mat9::Zero();
        if (stiffness_factor != 0.0) add_geometric(stiffness_factor * second_piola(F, rate), C);
        for (std::size_t k = 0; k < curves_.size(); ++k) {
          const Mat3 FM = F * tensors_[k];
          C += damping_factor * curves_[k].slope(tensors_[k].cwiseProduct(G).sum()) *
               FM.reshaped() * FM.reshaped().transpose();
        }
        add_tangent_blocks(C, weight, assembly_->shape_gradients(e, q), blocks);
      },
      A);
}

void ViscousForce::set_offsets(const Points& offset) { assembly_->set_offsets(offset); }

double ViscousForce::dissipation(const VecX& x, const VecX& v) const {
  return assembly_->sum([&](Index e, int q) {
    const Mat3 F = assembly_->gradient_of(x, e, q), rate = assembly_->rate_of(v, e, q);
    return (F.transpose() * rate).cwiseProduct(second_piola(F, rate)).sum();
  });
}

}  // namespace coxa::fem
