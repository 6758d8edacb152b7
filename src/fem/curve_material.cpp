#include <coxa/fem/curve_material.h>

#include <coxa/core/error.h>

#include <algorithm>

#include "mode_tensors.h"
#include "principal_material.h"

namespace coxa::fem {
namespace {

class CurveMaterial : public Material {
 public:
  explicit CurveMaterial(std::vector<StrainMode> modes) : modes_(std::move(modes)) {
    require(!modes_.empty(), "a material of curves needs at least one mode");
    for (const StrainMode& mode : modes_) tensors_.push_back(mode_tensor(mode.direction));
  }

  double energy_density(const Mat3& F) const override {
    const Mat3 E = green_strain(F);
    double sum = 0.0;
    for (std::size_t k = 0; k < modes_.size(); ++k)
      sum += modes_[k].stress.integral(tensors_[k].cwiseProduct(E).sum());
    return sum;
  }
  Mat3 first_piola(const Mat3& F) const override { return F * second_piola(green_strain(F)); }
  Mat9 tangent(const Mat3& F, Tangent kind) const override {
    const Mat3 E = green_strain(F), S = second_piola(E);
    Mat9 C = Mat9::Zero();
    add_geometric(kind == Tangent::positive ? tensile_part(S) : S, C);
    for (std::size_t k = 0; k < modes_.size(); ++k) {
      double slope = modes_[k].stress.slope(tensors_[k].cwiseProduct(E).sum());
      if (kind == Tangent::positive) slope = std::max(slope, 0.0);
      const Mat3 FM = F * tensors_[k];
      C += slope * FM.reshaped() * FM.reshaped().transpose();
    }
    return C;
  }

 private:
  static Mat3 green_strain(const Mat3& F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }
  Mat3 second_piola(const Mat3& E) const {
    Mat3 S = Mat3::Zero();
    for (std::size_t k = 0; k < modes_.size(); ++k)
      S += modes_[k].stress.value(tensors_[k].cwiseProduct(E).sum()) * tensors_[k];
    return S;
  }
  std::vector<StrainMode> modes_;
  std::vector<Mat3> tensors_;
};

class RotatedCurveMaterial : public PrincipalMaterial {
 public:
  RotatedCurveMaterial(Curve stress, Curve volume)
      : stress_(std::move(stress)), volume_(std::move(volume)) {}

 private:
  PrincipalResponse respond(const Vec3& stretch) const override {
    const Vec3 e = stretch - Vec3::Ones();
    const double sum = e.sum();
    PrincipalResponse r;
    r.energy = volume_.integral(sum);
    r.stress.setConstant(volume_.value(sum));
    r.stiffness.setConstant(volume_.slope(sum));
    for (int i = 0; i < 3; ++i) {
      r.energy += stress_.integral(e[i]);
      r.stress[i] += stress_.value(e[i]);
      r.stiffness(i, i) += stress_.slope(e[i]);
    }
    return r;
  }
  Curve stress_, volume_;
};

}  // namespace

std::vector<StrainMode> six_modes(const std::array<Curve, 6>& curves) {
  std::vector<StrainMode> modes;
  for (int k = 0; k < 6; ++k) modes.push_back({Vec6::Unit(k), curves[static_cast<std::size_t>(k)]});
  return modes;
}

StrainMode volume_mode(Curve stress) {
  return {(Vec6() << 1, 1, 1, 0, 0, 0).finished(), std::move(stress)};
}

std::vector<StrainMode> linear_modes(const Lame& lame) {
  const Curve tensile = Curve::line(2.0 * lame.mu), shear = Curve::line(lame.mu);
  std::vector<StrainMode> modes = six_modes({tensile, tensile, tensile, shear, shear, shear});
  modes.push_back(volume_mode(Curve::line(lame.lambda)));
  return modes;
}

std::unique_ptr<Material> make_curve_material(std::vector<StrainMode> modes) {
  return std::make_unique<CurveMaterial>(std::move(modes));
}
std::unique_ptr<Material> make_rotated_curve_material(Curve stress, Curve volume) {
  return std::make_unique<RotatedCurveMaterial>(std::move(stress), std::move(volume));
}

}  // namespace coxa::fem
