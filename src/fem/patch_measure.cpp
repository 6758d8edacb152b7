#include "patch_measure.h"

#include <algorithm>

#include "volume_measure.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

}  // namespace

PatchMeasure::PatchMeasure(const TetMesh& mesh, const std::vector<Index>& patch_of, ParticleMap map,
                           Dilatation dilatation)
    : patches_(list_patches(patch_of, mesh.n_tets())),
      assembly_(in_order_of(patches_, mesh), std::move(map), {}),
      measures_stretch_(dilatation == Dilatation::stretch_sum),
      measure_(make_volume_measure(dilatation)) {
  find_slots();
}

/// The distinct particles of each patch, and where the corners of its elements stand among them.
void PatchMeasure::find_slots() {
  const Size n = static_cast<Size>(assembly_.n_nodes());
  std::vector<std::int64_t> start{0};
  std::vector<Index> particle;
  slot_of_corner_.resize(patches_.elements.size() * n);
  for (Index patch = 0; patch < n_patches(); ++patch) {
    std::vector<Index> found;
    each_element(patch, [&](Index e) {
      for (int a = 0; a < assembly_.n_nodes(); ++a) found.push_back(assembly_.particle(e, a));
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    each_element(patch, [&](Index e) {
      for (int a = 0; a < assembly_.n_nodes(); ++a)
        slot_of_corner_[static_cast<Size>(e) * n + static_cast<Size>(a)] = static_cast<int>(
            std::lower_bound(found.begin(), found.end(), assembly_.particle(e, a)) - found.begin());
    });
    particle.insert(particle.end(), found.begin(), found.end());
    start.push_back(static_cast<std::int64_t>(particle.size()));
    double volume = 0.0;
    each_element(patch, [&](Index e) {
      for (int q = 0; q < assembly_.n_points(); ++q) volume += assembly_.weight(e, q);
    });
    rest_volume_.push_back(volume);
  }
  scatter_ = Scatter(std::move(start), std::move(particle));
}

double PatchMeasure::mean(const VecX& x, Index patch) const {
  double sum = 0.0;
  each_element(patch, [&](Index e) {
    for (int q = 0; q < assembly_.n_points(); ++q)
      sum += assembly_.weight(e, q) * measure_->energy_density(assembly_.gradient_of(x, e, q));
  });
  return sum / rest_volume(patch);
}

double PatchMeasure::mean_with_gradient(const VecX& x, Index patch, Vec3* gradient,
                                        Beside* beside) const {
  std::fill_n(gradient, scatter_.size(patch), Vec3::Zero());
  if (assembly_.n_nodes() == 4) return mean_in_lanes(x, patch, gradient, beside);
  double sum = 0.0;
  each_element(patch, [&](Index e) {
    for (int q = 0; q < assembly_.n_points(); ++q) {
      const double weight = assembly_.weight(e, q);
      const Mat3 F = assembly_.gradient_of(x, e, q);
      Mat3 slope, P;
      sum += weight * measure_->energy_with_piola(F, slope);
      for (int a = 0; a < assembly_.n_nodes(); ++a)
        gradient[slot(e, a)] += weight * (slope * assembly_.shape_gradient(e, q, a));
      if (beside == nullptr) continue;
      beside->energy += weight * beside->law->energy_with_piola(F, P);
      for (int a = 0; a < assembly_.n_nodes(); ++a)
        beside->force[slot(e, a)] -= weight * (P * assembly_.shape_gradient(e, q, a));
    }
  });
  return sum / rest_volume(patch);
}

/// The same for four-node elements, four at a time.
double PatchMeasure::mean_in_lanes(const VecX& x, Index patch, Vec3* gradient,
                                   Beside* beside) const {
  double sum = 0.0;
  const auto first = static_cast<Index>(patches_.start[static_cast<Size>(patch)]);
  const auto last = static_cast<Index>(patches_.start[static_cast<Size>(patch) + 1]);
  for (Index k = first; k < last; k += kLanes) {
    // the last group is filled up with its last element
    const int n = std::min<Index>(kLanes, last - k);
    Index element[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) element[lane] = std::min(k + lane, last - 1);
    ElementAssembly::LanePositions positions;
    LaneElements elements = assembly_.lane_elements(x, element, positions);
    double pull[kLanes][12], value[kLanes], density[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) elements.force[lane] = pull[lane];
    const auto add_pulls = [&](double factor, Vec3* sums) {
      for (int lane = 0; lane < n; ++lane)
        for (int a = 0; a < 4; ++a)
          sums[slot(k + lane, a)] += factor * Eigen::Map<const Vec3>(pull[lane] + 3 * a);
    };
    LaneMat3 F, slope, P;
    deformation_gradients(elements, F);
    measure_->energies_with_piolas(F, slope, value);
    for (int lane = 0; lane < n; ++lane) sum += elements.weight[lane] * value[lane];
    set_node_forces(elements, slope);
    add_pulls(-1.0, gradient);
    if (beside == nullptr) continue;
    if (measures_stretch_)
      beside->law->energies_with_known_rotations(F, slope, P, density);
    else
      beside->law->energies_with_piolas(F, P, density);
    for (int lane = 0; lane < n; ++lane) beside->energy += elements.weight[lane] * density[lane];
    set_node_forces(elements, P);
    add_pulls(1.0, beside->force);
  }
  return sum / rest_volume(patch);
}

void PatchMeasure::add_curvature(const VecX& x, Index patch, double factor, Mat3* blocks) const {
  const int n = scatter_.size(patch), nodes = assembly_.n_nodes();
  each_element(patch, [&](Index e) {
    Mat3 own[55];  // of up to ten nodes
    std::fill_n(own, nodes * (nodes + 1) / 2, Mat3::Zero());
    for (int q = 0; q < assembly_.n_points(); ++q)
      measure_->add_blocks(assembly_.gradient_of(x, e, q), Tangent::exact,
                           factor * assembly_.weight(e, q), assembly_.shape_gradients(e, q), own);
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

}  // namespace coxa::fem
