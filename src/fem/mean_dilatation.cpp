#include <coxa/fem/mean_dilatation.h>
#include <coxa/geom/cross_matrix.h>

#include <coxa/core/error.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "cofactor.h"
#include "element_assembly.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

/// Elements listed patch by patch.
struct PatchList {
  std::vector<std::int64_t> start{0};
  std::vector<Index> elements;
};

PatchList list_patches(const std::vector<Index>& patch_of, Index n_elements) {
  require(static_cast<Index>(patch_of.size()) == n_elements, "patches are given for ",
          patch_of.size(), " of ", n_elements, " elements");
  const Index n = patch_of.empty() ? 0 : *std::max_element(patch_of.begin(), patch_of.end()) + 1;
  std::vector<std::int64_t> count(static_cast<Size>(n), 0);
  for (const Index patch : patch_of) {
    require(patch >= 0, "an element belongs to patch ", patch);
    ++count[static_cast<Size>(patch)];
  }
  PatchList list;
  for (Index patch = 0; patch < n; ++patch) {
    require(count[static_cast<Size>(patch)] > 0, "patch ", patch, " has no element");
    list.start.push_back(list.start.back() + count[static_cast<Size>(patch)]);
  }
  list.elements.resize(patch_of.size());
  std::vector<std::int64_t> next(list.start.begin(), list.start.end() - 1);
  for (Size e = 0; e < patch_of.size(); ++e)
    list.elements[static_cast<Size>(next[static_cast<Size>(patch_of[e])]++)] =
        static_cast<Index>(e);
  return list;
}

}  // namespace

struct MeanDilatation::Impl {
  Impl(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda_, ParticleMap map)
      : assembly(mesh, std::move(map), {}),
        patches(list_patches(patch_of, mesh.n_tets())),
        lambda(lambda_) {
    require(lambda > 0.0, "lambda of the mean dilatation must be positive, got ", lambda, " MPa");
    find_slots();
  }

  Index n_patches() const { return static_cast<Index>(patches.start.size()) - 1; }
  /// Calls body(element, its place in the list) for the elements of a patch.
  template <class Body>
  void each_element(Index patch, const Body& body) const {
    for (auto k = patches.start[static_cast<Size>(patch)];
         k < patches.start[static_cast<Size>(patch) + 1]; ++k)
      body(patches.elements[static_cast<Size>(k)], static_cast<Size>(k));
  }

  /// The distinct particles of each patch, and where the corners of its elements stand among them.
  void find_slots() {
    const Size n = static_cast<Size>(assembly.n_nodes());
    std::vector<std::int64_t> start{0};
    std::vector<Index> particle;
    slot_of_corner.resize(patches.elements.size() * n);
    for (Index patch = 0; patch < n_patches(); ++patch) {
      std::vector<Index> found;
      each_element(patch, [&](Index e, Size) {
        for (int a = 0; a < assembly.n_nodes(); ++a) found.push_back(assembly.particle(e, a));
      });
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
      each_element(patch, [&](Index e, Size k) {
        for (int a = 0; a < assembly.n_nodes(); ++a)
          slot_of_corner[k * n + static_cast<Size>(a)] = static_cast<int>(
              std::lower_bound(found.begin(), found.end(), assembly.particle(e, a)) -
              found.begin());
      });
      particle.insert(particle.end(), found.begin(), found.end());
      start.push_back(static_cast<std::int64_t>(particle.size()));
      double volume = 0.0;
      each_element(patch, [&](Index e, Size) {
        for (int q = 0; q < assembly.n_points(); ++q) volume += assembly.weight(e, q);
      });
      rest_volume.push_back(volume);
    }
    scatter = Scatter(std::move(start), std::move(particle));
  }

  int slot(Size k, int a) const {
    return slot_of_corner[k * static_cast<Size>(assembly.n_nodes()) + static_cast<Size>(a)];
  }
  /// Volume over reference volume.
  double ratio(const VecX& x, Index patch) const {
    double volume = 0.0;
    each_element(patch, [&](Index e, Size) {
      for (int q = 0; q < assembly.n_points(); ++q)
        volume += assembly.weight(e, q) * assembly.gradient_of(x, e, q).determinant();
    });
    return volume / rest_volume[static_cast<Size>(patch)];
  }
  /// Gradient of the patch's volume by its slots.
  void volume_gradient(const VecX& x, Index patch, Vec3* gradient) const {
    std::fill_n(gradient, scatter.size(patch), Vec3::Zero());
    each_element(patch, [&](Index e, Size k) {
      for (int q = 0; q < assembly.n_points(); ++q) {
        const Mat3 C = assembly.weight(e, q) * cofactor(assembly.gradient_of(x, e, q));
        for (int a = 0; a < assembly.n_nodes(); ++a)
          gradient[slot(k, a)] += C * assembly.shape_gradient(e, q, a);
      }
    });
  }
  /// Adds factor times the second derivative of the patch's volume.
  void add_volume_hessian(const VecX& x, Index patch, double factor, Mat3* blocks) const {
    const int n = scatter.size(patch);
    each_element(patch, [&](Index e, Size k) {
      for (int q = 0; q < assembly.n_points(); ++q) {
        const Mat3 F = factor * assembly.weight(e, q) * assembly.gradient_of(x, e, q);
        for (int a = 0; a < assembly.n_nodes(); ++a)
          for (int b = 0; b < assembly.n_nodes(); ++b) {
            if (slot(k, a) > slot(k, b)) continue;
            // d2J / dx_a dx_b = -[F (r_a x r_b)]x
            blocks[Scatter::block_number(n, slot(k, a), slot(k, b))] -= cross_matrix(
                F * assembly.shape_gradient(e, q, a).cross(assembly.shape_gradient(e, q, b)));
          }
      }
    });
  }
  double slope(double J) const { return J > 0.0 ? lambda * std::log(J) / J : kNaN; }

  ElementAssembly assembly;
  PatchList patches;
  double lambda;
  std::vector<double> rest_volume;  // of each patch, mm³
  std::vector<int> slot_of_corner;  // per listed element and node
  Scatter scatter;
};

MeanDilatation::MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of,
                               double lambda, ParticleMap map)
    : impl_(std::make_unique<Impl>(mesh, patch_of, lambda, std::move(map))) {}

MeanDilatation::~MeanDilatation() = default;

std::vector<std::pair<Index, Index>> MeanDilatation::pattern() const {
  return impl_->scatter.pattern();
}

void MeanDilatation::add_force(const VecX& x, const VecX&, VecX& force) const {
  const auto part = std::make_unique_for_overwrite<Vec3[]>(impl_->scatter.n_slots());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    Vec3* mine = &part[impl_->scatter.slot(patch)];
    impl_->volume_gradient(x, patch, mine);
    const double pull = -impl_->slope(impl_->ratio(x, patch));
    for (int a = 0; a < impl_->scatter.size(patch); ++a) mine[a] *= pull;
  });
  impl_->scatter.gather_force(part.get(), force);
}

void MeanDilatation::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                  solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  const auto part = std::make_unique_for_overwrite<Mat3[]>(impl_->scatter.n_blocks());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const int n = impl_->scatter.size(patch);
    std::vector<Vec3> gradient(static_cast<Size>(n));
    impl_->volume_gradient(x, patch, gradient.data());
    const double J = impl_->ratio(x, patch);
    const double curvature = impl_->lambda * (1.0 - std::log(J)) / (J * J) /
                             impl_->rest_volume[static_cast<Size>(patch)];
    Mat3* blocks = &part[impl_->scatter.block(patch)];
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b)
        blocks[Scatter::block_number(n, a, b)] = stiffness_factor * curvature *
                                                 gradient[static_cast<Size>(a)] *
                                                 gradient[static_cast<Size>(b)].transpose();
    impl_->add_volume_hessian(x, patch, stiffness_factor * impl_->slope(J), blocks);
  });
  impl_->scatter.gather_blocks(part.get(), A);
}

double MeanDilatation::energy(const VecX& x) const {
  return parallel_reduce(
      impl_->n_patches(), 0.0,
      [&](Index patch) {
        const double J = impl_->ratio(x, patch);
        if (!(J > 0.0)) return kInfinity;
        const double log_J = std::log(J);
        return 0.5 * impl_->lambda * impl_->rest_volume[static_cast<Size>(patch)] * log_J * log_J;
      },
      [](double a, double b) { return a + b; });
}

void MeanDilatation::set_offsets(const Points& offset) { impl_->assembly.set_offsets(offset); }

VecX MeanDilatation::mean_stress(const VecX& x) const {
  VecX stress(impl_->assembly.n_elements());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const double value = impl_->slope(impl_->ratio(x, patch));
    impl_->each_element(patch, [&](Index e, Size) { stress[e] = value; });
  });
  return stress;
}

}  // namespace coxa::fem
