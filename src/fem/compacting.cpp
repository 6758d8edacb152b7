#include <coxa/core/error.h>
#include <coxa/fem/material.h>
#include <coxa/geom/cross_matrix.h>

#include <Eigen/LU>
#include <algorithm>

#include "cofactor.h"
#include "lanes.h"
#include "point_blocks.h"

namespace coxa::fem {
namespace {

// W = law(F) + bulk/2 min(0, J - J0)^2, so dW/dF = P_law - bulk (J0 - J) dJ/dF below J0
class Compacting : public Material {
 public:
  Compacting(std::unique_ptr<Material> law, const Compaction& compaction)
      : law_(std::move(law)), compaction_(compaction) {
    require(compaction.volume_ratio > 0.0 && compaction.volume_ratio < 1.0,
            "the volume ratio of full compaction must be in (0, 1), got ", compaction.volume_ratio);
    require(compaction.bulk > 0.0, "the bulk modulus of compaction must be positive, got ",
            compaction.bulk, " MPa");
  }

  double energy_density(const Mat3& F) const override {
    return law_->energy_density(F) + 0.5 * compaction_.bulk * excess(F) * excess(F);
  }
  Mat3 first_piola(const Mat3& F) const override {
    Mat3 P = law_->first_piola(F);
    add_piola(F, P);
    return P;
  }
  double energy_with_piola(const Mat3& F, Mat3& P) const override {
    const double energy = law_->energy_with_piola(F, P);
    add_piola(F, P);
    return energy + 0.5 * compaction_.bulk * excess(F) * excess(F);
  }

  void energies_with_piolas(const LaneMat3& F, LaneMat3& P, double* energy) const override {
    law_->energies_with_piolas(F, P, energy);
    compact(F, P, energy);
  }
  void energies_with_known_rotations(const LaneMat3& F, const LaneMat3& R, LaneMat3& P,
                                     double* energy) const override {
    law_->energies_with_known_rotations(F, R, P, energy);
    compact(F, P, energy);
  }

  // d(-bulk e C) = bulk C (C : dF) - bulk e dC, with e = J0 - J and C = dJ/dF; the first part is
  // positive, the second is what the positive tangent leaves out
  Mat9 tangent(const Mat3& F, Tangent kind) const override {
    Mat9 T = law_->tangent(F, kind);
    const double e = excess(F);
    if (e == 0.0) return T;
    const Mat3 C = cofactor(F);
    const auto c = C.reshaped();
    T += compaction_.bulk * c * c.transpose();
    if (kind == Tangent::positive) return T;
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        const Vec3 w = F * Vec3(Vec3::Unit(k).cross(Vec3::Unit(l)));
        T.block<3, 3>(3 * k, 3 * l) += compaction_.bulk * e * cross_matrix(w);
      }
    }
    return T;
  }
  void add_blocks(const Mat3& F, Tangent kind, double factor, std::span<const Vec3> r,
                  Mat3* blocks) const override {
    law_->add_blocks(F, kind, factor, r, blocks);
    const double e = excess(F);
    if (e == 0.0) return;
    const Mat3 C = cofactor(F);
    Vec3 c[10];
    for (std::size_t a = 0; a < r.size(); ++a) c[a] = C * r[a];
    add_pair_blocks(
        static_cast<int>(r.size()),
        [&](int a, int b) {
          Mat3 K = c[a] * c[b].transpose();
          if (kind == Tangent::exact) {
            const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
            K += e * cross_matrix(F * r[i].cross(r[j]));
          }
          return Mat3(factor * compaction_.bulk * K);
        },
        blocks);
  }

 private:
  double excess(const Mat3& F) const {
    return std::max(0.0, compaction_.volume_ratio - F.determinant());
  }
  void compact(const LaneMat3& F, LaneMat3& P, double* energy) const {
    if (least_determinant(F) >= compaction_.volume_ratio) return;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Mat3 own = matrix_of(F, lane);
      Mat3 stress = matrix_of(P, lane);
      add_piola(own, stress);
      set_matrix(P, lane, stress);
      energy[lane] += 0.5 * compaction_.bulk * excess(own) * excess(own);
    }
  }
  void add_piola(const Mat3& F, Mat3& P) const {
    if (const double e = excess(F); e > 0.0) P -= compaction_.bulk * e * cofactor(F);
  }

  std::unique_ptr<Material> law_;
  Compaction compaction_;
};

}  // namespace

std::unique_ptr<Material> make_compacting(std::unique_ptr<Material> law,
                                          const Compaction& compaction) {
  return std::make_unique<Compacting>(std::move(law), compaction);
}

}  // namespace coxa::fem
