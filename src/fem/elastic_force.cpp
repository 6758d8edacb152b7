#include <coxa/fem/elastic_force.h>

#include <coxa/core/error.h>

#include "element_assembly.h"
#include "element_shape.h"

namespace coxa::fem {

ElasticForce::ElasticForce(const TetMesh& mesh, std::unique_ptr<const Material> material,
                           ParticleMap map, ElasticOptions options)
    : material_(std::move(material)),
      tangent_(options.tangent),
      axes_(std::move(options.axes)),
      assembly_(std::make_unique<ElementAssembly>(mesh, std::move(map), axes_)) {
  COXA_ASSERT(material_ != nullptr);
}

ElasticForce::~ElasticForce() = default;

std::vector<std::pair<Index, Index>> ElasticForce::pattern() const { return assembly_->pattern(); }

void ElasticForce::add_force(const VecX& x, const VecX&, VecX& force) const {
  if (assembly_->n_nodes() == 4) {
    assembly_->add_force_in_lanes(*material_, x, force);
    return;
  }
  assembly_->add_force(
      [&](Index e, int q) { return material_->first_piola(assembly_->gradient_of(x, e, q)); },
      force);
}

void ElasticForce::add_jacobian(const VecX& x, const VecX&, double stiffness_factor, double,
                                solve::BlockMatrix& A) const {
  if (stiffness_factor == 0.0) return;
  assembly_->add_jacobian(
      [&](Index e, int q, double weight, Mat3* blocks) {
        material_->add_blocks(assembly_->gradient_of(x, e, q), tangent_, stiffness_factor * weight,
                              assembly_->shape_gradients(e, q), blocks);
      },
      A);
}

double ElasticForce::energy(const VecX& x) const {
  return assembly_->sum(
      [&](Index e, int q) { return material_->energy_density(assembly_->gradient_of(x, e, q)); });
}

double ElasticForce::add_force_with_energy(const VecX& x, VecX& force) const {
  if (assembly_->n_nodes() == 4) return assembly_->add_force_in_lanes(*material_, x, force);
  VecX energy = VecX::Zero(n_elements());
  assembly_->add_force(
      [&](Index e, int q) {
        Mat3 P;
        energy[e] += assembly_->weight(e, q) *
                     material_->energy_with_piola(assembly_->gradient_of(x, e, q), P);
        return P;
      },
      force);
  return energy.sum();
}

void ElasticForce::set_offsets(const Points& offset) { assembly_->set_offsets(offset); }

Points ElasticForce::node_positions(const VecX& x) const { return assembly_->node_positions(x); }

Index ElasticForce::n_elements() const { return assembly_->n_elements(); }

VecX ElasticForce::volumes() const {
  VecX volumes = VecX::Zero(n_elements());
  for (Index e = 0; e < n_elements(); ++e)
    for (int q = 0; q < assembly_->n_points(); ++q) volumes[e] += assembly_->weight(e, q);
  return volumes;
}

Mat3 ElasticForce::deformation_gradient(const VecX& x, Index e) const {
  Mat3 sum = Mat3::Zero();
  double volume = 0.0;
  for (int q = 0; q < assembly_->n_points(); ++q) {
    sum += assembly_->weight(e, q) * assembly_->gradient_of(x, e, q);
    volume += assembly_->weight(e, q);
  }
  sum /= volume;
  return axes_.empty() ? sum : Mat3(sum * axes_[static_cast<std::size_t>(e)].transpose());
}

Mat3 ElasticForce::cauchy_stress(const VecX& x, Index e) const {
  Mat3 sum = Mat3::Zero();
  double volume = 0.0;
  for (int q = 0; q < assembly_->n_points(); ++q) {
    const Mat3 F = assembly_->gradient_of(x, e, q);
    sum += assembly_->weight(e, q) * cauchy_from(material_->first_piola(F), F);
    volume += assembly_->weight(e, q);
  }
  return sum / volume;
}

VecX lumped_masses(const TetMesh& mesh, double density, Index n_particles, const ParticleMap& map) {
  require(density > 0.0, "density must be positive, got ", density, " tonne/mm3");
  check_connectivity(mesh);
  const int n = nodes_per_element(mesh);
  const double corner = n == 4 ? 0.25 : 1.0 / 36.0, middle = 4.0 / 27.0;
  VecX mass = VecX::Zero(n_particles);
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    double volume = 0.0;
    for (const double weight : element_shape(mesh, e).weight) volume += weight;
    for (int a = 0; a < n; ++a) {
      const Index node = element_node(mesh, e, a);
      const Index particle =
          map.particle_of.empty() ? node : map.particle_of.at(static_cast<std::size_t>(node));
      require(particle >= 0 && particle < n_particles, "node ", node, " is tied to particle ",
              particle, " of ", n_particles);
      mass[particle] += density * volume * (a < 4 ? corner : middle);
    }
  }
  return mass;
}

}  // namespace coxa::fem
