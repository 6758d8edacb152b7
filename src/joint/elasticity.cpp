#include "elasticity.h"

#include <coxa/core/error.h>

#include <numeric>

namespace coxa::joint {
namespace {

// what the solid resists with, in confined moduli of the tissue: much stiffer, and still solvable
constexpr double kSolidStiffness = 100.0;

std::unique_ptr<fem::Material> compacting(std::unique_ptr<fem::Material> law,
                                          const fem::Lame& lame) {
  const double confined = lame.lambda + 2.0 * lame.mu;
  return fem::make_compacting(std::move(law), {kSolidShare, kSolidStiffness * confined});
}

std::unique_ptr<fem::Material> make_law(const CartilageMaterial& material) {
  const fem::Lame lame = fem::lame_from(material.youngs_modulus, material.poissons_ratio);
  switch (material.law) {
    case MaterialLaw::corotational:
      return compacting(fem::make_corotational(lame), lame);
    case MaterialLaw::st_venant_kirchhoff:
      return compacting(fem::make_st_venant_kirchhoff(lame), lame);
    case MaterialLaw::neo_hookean:
      break;
  }
  return fem::make_neo_hookean({0.0, lame.mu});  // volume change is resisted by patches
}

}  // namespace

CartilageElasticity::CartilageElasticity(const TetMesh& mesh, Index first_particle,
                                         const CartilageMaterial& material) {
  fem::ParticleMap map;
  map.particle_of.resize(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(map.particle_of.begin(), map.particle_of.end(), first_particle);
  by_element_ = std::make_unique<fem::ElasticForce>(
      mesh, make_law(material), map,
      fem::ElasticOptions{.axes = {}, .tangent = fem::Tangent::positive});
  if (material.law != MaterialLaw::neo_hookean) return;
  const double lambda = fem::lame_from(material.youngs_modulus, material.poissons_ratio).lambda;
  by_patch_ = std::make_unique<fem::MeanDilatation>(mesh, fem::volume_patches(mesh), lambda, map);
}

std::vector<const dynamics::Force*> CartilageElasticity::forces() const {
  if (!by_patch_) return {by_element_.get()};
  return {by_element_.get(), by_patch_.get()};
}

double CartilageElasticity::add_force_with_energy(const VecX& x, VecX& force) const {
  double energy = by_element_->add_force_with_energy(x, force);
  if (by_patch_) {
    energy += by_patch_->energy(x);
    by_patch_->add_force(x, VecX(), force);
  }
  return energy;
}

VecX CartilageElasticity::mean_stress(const VecX& x) const {
  return by_patch_ ? by_patch_->mean_stress(x) : VecX(VecX::Zero(by_element_->n_elements()));
}

}  // namespace coxa::joint
