#include <coxa/fem/mean_dilatation.h>

#include <coxa/core/error.h>

#include <algorithm>

#include "element_assembly.h"
#include "patch_list.h"
#include "volume_measure.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

}  // namespace

struct MeanDilatation::Impl {
  Impl(const TetMesh& mesh, const std::vector<Index>& patch_of, double lambda_, ParticleMap map,
       const Options& options_)
      : patches(list_patches(patch_of, mesh.n_tets())),
        assembly(in_order_of(patches, mesh), std::move(map), {}),
        lambda(lambda_),
        options(options_),
        measure(make_volume_measure(options_.dilatation)) {
    require(lambda > 0.0, "lambda of the mean dilatation must be positive, got ", lambda, " MPa");
    find_slots();
  }

  Index n_patches() const { return static_cast<Index>(patches.start.size()) - 1; }
  /// Calls body(place in the list) for the elements of a patch.
  template <class Body>
  void each_element(Index patch, const Body& body) const {
    for (auto k = patches.start[static_cast<Size>(patch)];
         k < patches.start[static_cast<Size>(patch) + 1]; ++k)
      body(static_cast<Index>(k));
  }

  /// The distinct particles of each patch, and where the corners of its elements stand among them.
  void find_slots() {
    const Size n = static_cast<Size>(assembly.n_nodes());
    std::vector<std::int64_t> start{0};
    std::vector<Index> particle;
    slot_of_corner.resize(patches.elements.size() * n);
    for (Index patch = 0; patch < n_patches(); ++patch) {
      std::vector<Index> found;
      each_element(patch, [&](Index e) {
        for (int a = 0; a < assembly.n_nodes(); ++a) found.push_back(assembly.particle(e, a));
      });
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
      each_element(patch, [&](Index e) {
        for (int a = 0; a < assembly.n_nodes(); ++a)
          slot_of_corner[static_cast<Size>(e) * n + static_cast<Size>(a)] = static_cast<int>(
              std::lower_bound(found.begin(), found.end(), assembly.particle(e, a)) -
              found.begin());
      });
      particle.insert(particle.end(), found.begin(), found.end());
      start.push_back(static_cast<std::int64_t>(particle.size()));
      double volume = 0.0;
      each_element(patch, [&](Index e) {
        for (int q = 0; q < assembly.n_points(); ++q) volume += assembly.weight(e, q);
      });
      rest_volume.push_back(volume);
    }
    scatter = Scatter(std::move(start), std::move(particle));
  }

  int slot(Index e, int a) const {
    return slot_of_corner[static_cast<Size>(e) * static_cast<Size>(assembly.n_nodes()) +
                          static_cast<Size>(a)];
  }
  /// Mean of the measure over the patch.
  double mean(const VecX& x, Index patch) const {
    double sum = 0.0;
    each_element(patch, [&](Index e) {
      for (int q = 0; q < assembly.n_points(); ++q)
        sum += assembly.weight(e, q) * measure->energy_density(assembly.gradient_of(x, e, q));
    });
    return sum / rest_volume[static_cast<Size>(patch)];
  }
  /// The same; sets the gradient of mean times rest volume by the patch's slots.
  double mean_with_gradient(const VecX& x, Index patch, Vec3* gradient) const {
    if (assembly.n_nodes() == 4) return mean_in_lanes(x, patch, gradient);
    std::fill_n(gradient, scatter.size(patch), Vec3::Zero());
    double sum = 0.0;
    each_element(patch, [&](Index e) {
      for (int q = 0; q < assembly.n_points(); ++q) {
        const double weight = assembly.weight(e, q);
        Mat3 slope;
        sum += weight * measure->energy_with_piola(assembly.gradient_of(x, e, q), slope);
        for (int a = 0; a < assembly.n_nodes(); ++a)
          gradient[slot(e, a)] += weight * (slope * assembly.shape_gradient(e, q, a));
      }
    });
    return sum / rest_volume[static_cast<Size>(patch)];
  }
  /// The same for four-node elements, four at a time.
  double mean_in_lanes(const VecX& x, Index patch, Vec3* gradient) const {
    std::fill_n(gradient, scatter.size(patch), Vec3::Zero());
    double sum = 0.0;
    const auto first = static_cast<Index>(patches.start[static_cast<Size>(patch)]);
    const auto last = static_cast<Index>(patches.start[static_cast<Size>(patch) + 1]);
    for (Index k = first; k < last; k += kLanes) {
      // the last group is filled up with its last element
      const int n = std::min<Index>(kLanes, last - k);
      Index element[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) element[lane] = std::min(k + lane, last - 1);
      ElementAssembly::LanePositions positions;
      LaneElements elements = assembly.lane_elements(x, element, positions);
      double pull[kLanes][12], value[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) elements.force[lane] = pull[lane];
      LaneMat3 F, slope;
      deformation_gradients(elements, F);
      measure->energies_with_piolas(F, slope, value);
      set_node_forces(elements, slope);
      for (int lane = 0; lane < n; ++lane) {
        sum += elements.weight[lane] * value[lane];
        for (int a = 0; a < 4; ++a)
          gradient[slot(k + lane, a)] -= Eigen::Map<const Vec3>(pull[lane] + 3 * a);
      }
    }
    return sum / rest_volume[static_cast<Size>(patch)];
  }
  /// Adds factor times the second derivative of mean times rest volume.
  void add_curvature(const VecX& x, Index patch, double factor, Mat3* blocks) const {
    const int n = scatter.size(patch), nodes = assembly.n_nodes();
    each_element(patch, [&](Index e) {
      Mat3 own[55];  // of up to ten nodes
      std::fill_n(own, nodes * (nodes + 1) / 2, Mat3::Zero());
      for (int q = 0; q < assembly.n_points(); ++q)
        measure->add_blocks(assembly.gradient_of(x, e, q), Tangent::exact,
                            factor * assembly.weight(e, q), assembly.shape_gradients(e, q), own);
      for (int a = 0; a < nodes; ++a)
        for (int b = a; b < nodes; ++b) {
          const Mat3& block = own[Scatter::block_number(nodes, a, b)];
          const int i = slot(e, a), j = slot(e, b);
          if (i <= j) blocks[Scatter::block_number(n, i, j)] += block;
          // both orders of a pair fall on the same block where its nodes share a particle
          if (i > j || (i == j && a != b))
            blocks[Scatter::block_number(n, j, i)] += block.transpose();
        }
    });
  }
  VolumeResistance resistance(double m) const {
    return volume_resistance(options.dilatation, lambda, m);
  }
  double term_stiffness(const VolumeResistance& resistance, Index patch) const {
    return resistance.curvature / rest_volume[static_cast<Size>(patch)];
  }
  /// Whether the tangent asked for holds the curvature of the measure.
  bool is_curved(const VolumeResistance& resistance) const {
    return options.tangent == Tangent::exact || !is_convex(options.dilatation) ||
           resistance.slope > 0.0;
  }

  PatchList patches;
  ElementAssembly assembly;  // elements in the order of the list
  double lambda;
  Options options;
  std::unique_ptr<const Material> measure;
  std::vector<double> rest_volume;  // of each patch, mm³
  std::vector<int> slot_of_corner;  // per listed element and node
  Scatter scatter;
};

MeanDilatation::MeanDilatation(const TetMesh& mesh, const std::vector<Index>& patch_of,
                               double lambda, ParticleMap map, const Options& options)
    : impl_(std::make_unique<Impl>(mesh, patch_of, lambda, std::move(map), options)) {}

MeanDilatation::~MeanDilatation() = default;

std::vector<std::pair<Index, Index>> MeanDilatation::pattern() const {
  return impl_->scatter.pattern();
}

void MeanDilatation::add_force(const VecX& x, const VecX&, VecX& force) const {
  add_force_with_energy(x, force);
}

double MeanDilatation::add_force_with_energy(const VecX& x, VecX& force) const {
  const auto part = std::make_unique_for_overwrite<Vec3[]>(impl_->scatter.n_slots());
  VecX energy(impl_->n_patches());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    Vec3* mine = &part[impl_->scatter.slot(patch)];
    const auto resistance = impl_->resistance(impl_->mean_with_gradient(x, patch, mine));
    energy[patch] = impl_->rest_volume[static_cast<Size>(patch)] * resistance.energy;
    for (int a = 0; a < impl_->scatter.size(patch); ++a) mine[a] *= -resistance.slope;
  });
  impl_->scatter.gather_force(part.get(), force);
  return energy.sum();
}

void MeanDilatation::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                  solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  const auto part = std::make_unique_for_overwrite<Mat3[]>(impl_->scatter.n_blocks());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const int n = impl_->scatter.size(patch);
    std::vector<Vec3> gradient(static_cast<Size>(n));
    const auto resistance = impl_->resistance(impl_->mean_with_gradient(x, patch, gradient.data()));
    const double stiffness = impl_->term_stiffness(resistance, patch);
    Mat3* blocks = &part[impl_->scatter.block(patch)];
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b)
        blocks[Scatter::block_number(n, a, b)] = stiffness_factor * stiffness *
                                                 gradient[static_cast<Size>(a)] *
                                                 gradient[static_cast<Size>(b)].transpose();
    if (impl_->is_curved(resistance))
      impl_->add_curvature(x, patch, stiffness_factor * resistance.slope, blocks);
  });
  impl_->scatter.gather_blocks(part.get(), A);
}

void MeanDilatation::add_element_jacobian(const VecX& x, solve::BlockMatrix& A) const {
  VecX slope = VecX::Zero(impl_->assembly.n_elements());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const auto resistance = impl_->resistance(impl_->mean(x, patch));
    if (!impl_->is_curved(resistance)) return;
    impl_->each_element(patch, [&](Index e) { slope[e] = resistance.slope; });
  });
  impl_->assembly.add_jacobian(
      [&](Index e, int q, double weight, Mat3* blocks) {
        if (slope[e] == 0.0) return;
        impl_->measure->add_blocks(impl_->assembly.gradient_of(x, e, q), Tangent::exact,
                                   slope[e] * weight, impl_->assembly.shape_gradients(e, q),
                                   blocks);
      },
      A);
}

PatchTerms MeanDilatation::patch_terms(const VecX& x) const {
  const Scatter& scatter = impl_->scatter;
  PatchTerms terms;
  terms.stiffness.resize(static_cast<Size>(impl_->n_patches()));
  terms.slope.resize(scatter.n_slots());
  for (Index patch = 0; patch <= impl_->n_patches(); ++patch)
    terms.start.push_back(static_cast<std::int64_t>(scatter.slot(patch)));
  for (Size slot = 0; slot < scatter.n_slots(); ++slot)
    terms.particle.push_back(scatter.particle(slot));
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const auto resistance =
        impl_->resistance(impl_->mean_with_gradient(x, patch, &terms.slope[scatter.slot(patch)]));
    terms.stiffness[static_cast<Size>(patch)] = impl_->term_stiffness(resistance, patch);
  });
  return terms;
}

double MeanDilatation::energy(const VecX& x) const {
  return parallel_reduce(
      impl_->n_patches(), 0.0,
      [&](Index patch) {
        return impl_->rest_volume[static_cast<Size>(patch)] *
               impl_->resistance(impl_->mean(x, patch)).energy;
      },
      [](double a, double b) { return a + b; });
}

void MeanDilatation::set_offsets(const Points& offset) { impl_->assembly.set_offsets(offset); }

std::vector<Mat3> MeanDilatation::cauchy_stress(const VecX& x) const {
  const ElementAssembly& assembly = impl_->assembly;
  std::vector<Mat3> stress(static_cast<Size>(assembly.n_elements()), Mat3::Zero());
  parallel_for(impl_->n_patches(), [&](Index patch) {
    const double slope = impl_->resistance(impl_->mean(x, patch)).slope;
    impl_->each_element(patch, [&](Index e) {
      double volume = 0.0;
      Mat3& sum = stress[static_cast<Size>(impl_->patches.elements[static_cast<Size>(e)])];
      for (int q = 0; q < assembly.n_points(); ++q) {
        const Mat3 F = assembly.gradient_of(x, e, q);
        sum += assembly.weight(e, q) * cauchy_from(slope * impl_->measure->first_piola(F), F);
        volume += assembly.weight(e, q);
      }
      sum /= volume;
    });
  });
  return stress;
}

}  // namespace coxa::fem
