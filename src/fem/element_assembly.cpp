#include "element_assembly.h"

#include <coxa/core/error.h>

#include <algorithm>
#include <numeric>

#include "element_shape.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

void check_axes(const std::vector<Mat3>& axes, Index n_elements) {
  require(axes.empty() || static_cast<Index>(axes.size()) == n_elements,
          "material axes are given for ", axes.size(), " of ", n_elements, " elements");
  for (Size e = 0; e < axes.size(); ++e)
    require((axes[e].transpose() * axes[e] - Mat3::Identity()).norm() < 1e-6,
            "the material axes of element ", e, " are not orthonormal");
}

}  // namespace

ElementAssembly::ElementAssembly(const TetMesh& mesh, ParticleMap map,
                                 const std::vector<Mat3>& axes)
    : n_elements_(mesh.n_tets()), n_nodes_(nodes_per_element(mesh)) {
  check_connectivity(mesh);
  check_axes(axes, n_elements_);
  if (map.particle_of.empty()) {
    map.particle_of.resize(static_cast<Size>(mesh.n_vertices()));
    std::iota(map.particle_of.begin(), map.particle_of.end(), Index{0});
  }
  require(static_cast<Index>(map.particle_of.size()) == mesh.n_vertices(), "the particle map has ",
          map.particle_of.size(), " entries for ", mesh.n_vertices(), " nodes");
  offset_ = Points::Zero(mesh.n_vertices(), 3);
  if (map.offset.rows() > 0) set_offsets(map.offset);

  std::vector<Index> particle;
  for (Index e = 0; e < n_elements_; ++e) {
    ElementShape shape = element_shape(mesh, e);
    n_points_ = static_cast<int>(shape.weight.size());
    weight_.insert(weight_.end(), shape.weight.begin(), shape.weight.end());
    for (const Vec3& gradient : shape.gradient)
      shape_gradient_.push_back(
          axes.empty() ? gradient : Vec3(axes[static_cast<Size>(e)].transpose() * gradient));
    for (int a = 0; a < n_nodes_; ++a) {
      node_.push_back(element_node(mesh, e, a));
      particle.push_back(map.particle_of[static_cast<Size>(node_.back())]);
      require(particle.back() >= 0, "node ", node_.back(), " is tied to particle ",
              particle.back());
    }
  }
  std::vector<std::int64_t> start(static_cast<Size>(n_elements_) + 1);
  for (Size e = 0; e < start.size(); ++e) start[e] = static_cast<std::int64_t>(e) * n_nodes_;
  scatter_ = Scatter(std::move(start), std::move(particle));
}

LaneElements ElementAssembly::lane_elements(const VecX& x, const Index (&element)[kLanes],
                                            LanePositions& positions) const {
  LaneElements elements;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Index e = element[lane];
    for (int a = 0; a < 4; ++a) {
      const Size k = corner(e, a);
      positions.of[lane][a] =
          x.segment<3>(3 * Eigen::Index{scatter_.particle(k)}) + offset_.row(node_[k]).transpose();
      elements.position[lane][a] = positions.of[lane][a].data();
    }
    elements.gradient[lane] = shape_gradient_[4 * static_cast<Size>(e)].data();
    elements.weight[lane] = weight_[static_cast<Size>(e)];
  }
  return elements;
}

double ElementAssembly::add_force_in_lanes(const Material& material, const VecX& x,
                                           VecX& force) const {
  part_.resize(node_.size());
  VecX energies(n_elements_);
  parallel_for((n_elements_ + kLanes - 1) / kLanes, [&](Index group) {
    // the last group is filled up with its last element
    Index element[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      element[lane] = std::min(kLanes * group + lane, n_elements_ - 1);
    LanePositions positions;
    LaneElements elements = lane_elements(x, element, positions);
    for (int lane = 0; lane < kLanes; ++lane)
      elements.force[lane] = part_[4 * static_cast<Size>(element[lane])].data();
    LaneMat3 F, P;
    double density[kLanes];
    deformation_gradients(elements, F);
    material.energies_with_piolas(F, P, density);
    set_node_forces(elements, P);
    for (int lane = 0; lane < kLanes; ++lane)
      energies[element[lane]] = elements.weight[lane] * density[lane];
  });
  scatter_.gather_force(part_.data(), force);
  return energies.sum();
}

void ElementAssembly::set_offsets(const Points& offset) {
  require(offset.rows() == offset_.rows(), "offsets are given for ", offset.rows(), " of ",
          offset_.rows(), " nodes");
  offset_ = offset;
}

Points ElementAssembly::node_positions(const VecX& x) const {
  Points positions = Points::Constant(offset_.rows(), 3, kNaN);
  for (Size k = 0; k < node_.size(); ++k)
    positions.row(node_[k]) =
        x.segment<3>(3 * Eigen::Index{scatter_.particle(k)}).transpose() + offset_.row(node_[k]);
  return positions;
}

}  // namespace coxa::fem
