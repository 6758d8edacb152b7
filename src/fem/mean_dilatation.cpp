#include <coxa/fem/mean_dilatation.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <algorithm>

#include "patch_measure.h"
#include "volume_measure.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

}  // namespace

struct MeanDilatation::Impl {
  Impl(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda_, ParticleMap map,
       const Options& options_)
      : patches(mesh, patch_of, std::move(map), options_.dilatation),
        lambda(lambda_),
        options(options_) {
    require(lambda > 0.0, "lambda of the mean dilatation must be positive, got ", lambda, " MPa");
  }

  VolumeResistance resistance(double m) const {
    return volume_resistance(options.dilatation, lambda, m);
  }
  double term_stiffness(const VolumeResistance& resistance, Index patch) const {
    return resistance.curvature / patches.rest_volume(patch);
  }
  /// Whether the tangent asked for holds the curvature of the measure.
  bool is_curved(const VolumeResistance& resistance) const {
    return options.tangent == Tangent::exact || !is_convex(options.dilatation) ||
           resistance.slope > 0.0;
  }
  double add_force(const VecX& x, const Material* beside, VecX& force) const;
  void add_element_jacobian(const VecX& x, const Material* beside, solve::BlockMatrix& A) const;

  PatchMeasure patches;
  double lambda;
  Options options;
  // forces of the patches' slots, kept for the next call
  mutable std::vector<Vec3> part;
};

MeanDilatation::MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of,
                               double lambda, ParticleMap map, const Options& options)
    : impl_(std::make_unique<Impl>(mesh, patch_of, lambda, std::move(map), options)) {}

MeanDilatation::~MeanDilatation() = default;

std::vector<std::pair<Index, Index>> MeanDilatation::pattern() const {
  return impl_->patches.scatter().pattern();
}

void MeanDilatation::add_force(const VecX& x, const VecX&, VecX& force) const {
  add_force_with_energy(x, force);
}

double MeanDilatation::Impl::add_force(const VecX& x, const Material* beside, VecX& force) const {
  const Scatter& scatter = patches.scatter();
  part.resize(scatter.n_slots());
  VecX energy(patches.n_patches());
  parallel_for(patches.n_patches(), [&](Index patch) {
    Vec3* mine = &part[scatter.slot(patch)];
    const auto n = static_cast<Size>(scatter.size(patch));
    thread_local std::vector<Vec3> own;
    own.assign(n, Vec3::Zero());
    PatchMeasure::Beside law{beside, own.data()};
    const auto pushed =
        resistance(patches.mean_with_gradient(x, patch, mine, beside != nullptr ? &law : nullptr));
    energy[patch] = law.energy + patches.rest_volume(patch) * pushed.energy;
    for (Size a = 0; a < n; ++a) mine[a] = own[a] - pushed.slope * mine[a];
  });
  scatter.gather_force(part.data(), force);
  return energy.sum();
}

double MeanDilatation::add_force_with_energy(const VecX& x, VecX& force) const {
  return impl_->add_force(x, nullptr, force);
}

double MeanDilatation::add_force_with_energy(const VecX& x, const Material& beside,
                                             VecX& force) const {
  return impl_->add_force(x, &beside, force);
}

void MeanDilatation::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                  solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  const auto part = std::make_unique_for_overwrite<Mat3[]>(impl_->patches.scatter().n_blocks());
  parallel_for(impl_->patches.n_patches(), [&](Index patch) {
    const int n = impl_->patches.scatter().size(patch);
    std::vector<Vec3> gradient(static_cast<Size>(n));
    const auto resistance =
        impl_->resistance(impl_->patches.mean_with_gradient(x, patch, gradient.data()));
    const double stiffness = impl_->term_stiffness(resistance, patch);
    Mat3* blocks = &part[impl_->patches.scatter().block(patch)];
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b)
        blocks[Scatter::block_number(n, a, b)] = stiffness_factor * stiffness *
                                                 gradient[static_cast<Size>(a)] *
                                                 gradient[static_cast<Size>(b)].transpose();
    if (impl_->is_curved(resistance))
      impl_->patches.add_curvature(x, patch, stiffness_factor * resistance.slope, blocks);
  });
  impl_->patches.scatter().gather_blocks(part.get(), A);
}

void MeanDilatation::Impl::add_element_jacobian(const VecX& x, const Material* beside,
                                                solve::BlockMatrix& A) const {
  const ElementAssembly& assembly = patches.assembly();
  VecX slope = VecX::Zero(assembly.n_elements());
  parallel_for(patches.n_patches(), [&](Index patch) {
    const auto pushed = resistance(patches.mean(x, patch));
    if (!is_curved(pushed)) return;
    patches.each_element(patch, [&](Index e) { slope[e] = pushed.slope; });
  });
  assembly.add_jacobian(
      [&](Index e, int q, double weight, Mat3* blocks) {
        if (beside == nullptr && slope[e] == 0.0) return;
        const Mat3 F = assembly.gradient_of(x, e, q);
        const auto r = assembly.shape_gradients(e, q);
        if (beside != nullptr) beside->add_blocks(F, options.tangent, weight, r, blocks);
        if (slope[e] == 0.0) return;
        patches.measure().add_blocks(F, Tangent::exact, slope[e] * weight, r, blocks);
      },
      A);
}

void MeanDilatation::add_element_jacobian(const VecX& x, solve::BlockMatrix& A) const {
  impl_->add_element_jacobian(x, nullptr, A);
}

void MeanDilatation::add_element_jacobian(const VecX& x, const Material& beside,
                                          solve::BlockMatrix& A) const {
  impl_->add_element_jacobian(x, &beside, A);
}

PatchTerms MeanDilatation::patch_terms(const VecX& x) const {
  const Scatter& scatter = impl_->patches.scatter();
  PatchTerms terms;
  terms.stiffness.resize(static_cast<Size>(impl_->patches.n_patches()));
  terms.slope.resize(scatter.n_slots());
  for (Index patch = 0; patch <= impl_->patches.n_patches(); ++patch)
    terms.start.push_back(static_cast<std::int64_t>(scatter.slot(patch)));
  for (Size slot = 0; slot < scatter.n_slots(); ++slot)
    terms.particle.push_back(scatter.particle(slot));
  parallel_for(impl_->patches.n_patches(), [&](Index patch) {
    const auto resistance = impl_->resistance(
        impl_->patches.mean_with_gradient(x, patch, &terms.slope[scatter.slot(patch)]));
    terms.stiffness[static_cast<Size>(patch)] = impl_->term_stiffness(resistance, patch);
  });
  return terms;
}

double MeanDilatation::energy(const VecX& x) const {
  return parallel_reduce(
      impl_->patches.n_patches(), 0.0,
      [&](Index patch) {
        return impl_->patches.rest_volume(patch) *
               impl_->resistance(impl_->patches.mean(x, patch)).energy;
      },
      [](double a, double b) { return a + b; });
}

void MeanDilatation::set_offsets(const Points& offset) { impl_->patches.set_offsets(offset); }

std::vector<Mat3> MeanDilatation::cauchy_stress(const VecX& x) const {
  const ElementAssembly& assembly = impl_->patches.assembly();
  std::vector<Mat3> stress(static_cast<Size>(assembly.n_elements()), Mat3::Zero());
  parallel_for(impl_->patches.n_patches(), [&](Index patch) {
    const double slope = impl_->resistance(impl_->patches.mean(x, patch)).slope;
    impl_->patches.each_element(patch, [&](Index e) {
      double volume = 0.0;
      Mat3& sum = stress[static_cast<Size>(impl_->patches.element(e))];
      for (int q = 0; q < assembly.n_points(); ++q) {
        const Mat3 F = assembly.gradient_of(x, e, q);
        sum +=
            assembly.weight(e, q) * cauchy_from(slope * impl_->patches.measure().first_piola(F), F);
        volume += assembly.weight(e, q);
      }
      sum /= volume;
    });
  });
  return stress;
}

}  // namespace coxa::fem
