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

/// The law; `lame` without its lambda where volume change is resisted by patches.
std::unique_ptr<fem::Material> make_law(MaterialLaw law, const fem::Lame& lame,
                                        const fem::Lame& whole) {
  switch (law) {
    case MaterialLaw::corotational:
      return compacting(fem::make_corotational(lame), whole);
    case MaterialLaw::st_venant_kirchhoff:
      return compacting(fem::make_st_venant_kirchhoff(lame), whole);
    case MaterialLaw::neo_hookean:
      break;
  }
  return fem::make_neo_hookean(lame);
}

fem::Dilatation dilatation_of(MaterialLaw law) {
  return law == MaterialLaw::corotational          ? fem::Dilatation::stretch_sum
         : law == MaterialLaw::st_venant_kirchhoff ? fem::Dilatation::green_trace
                                                   : fem::Dilatation::log_volume;
}

}  // namespace

CartilageElasticity::CartilageElasticity(const TetMesh& mesh, Index first_particle,
                                         const CartilageMaterial& material) {
  fem::ParticleMap map;
  map.particle_of.resize(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(map.particle_of.begin(), map.particle_of.end(), first_particle);
  const fem::Lame whole = fem::lame_from(material.youngs_modulus, material.poissons_ratio);
  const bool by_patches = material.volume_change == VolumeChange::by_patches;
  by_element_ = std::make_unique<fem::ElasticForce>(
      mesh, make_law(material.law, {by_patches ? 0.0 : whole.lambda, whole.mu}, whole), map,
      fem::ElasticOptions{.axes = {}, .tangent = fem::Tangent::positive});
  if (!by_patches) return;
  by_patch_ = std::make_unique<fem::MeanDilatation>(
      mesh, fem::volume_patches(mesh), whole.lambda, map,
      fem::MeanDilatation::Options{dilatation_of(material.law), fem::Tangent::positive});
}

double CartilageElasticity::add_force_with_energy(const VecX& x, VecX& force) const {
  return by_patch_ ? by_patch_->add_force_with_energy(x, by_element_->material(), force)
                   : by_element_->add_force_with_energy(x, force);
}

void CartilageElasticity::add_element_jacobian(const VecX& x, solve::BlockMatrix& A) const {
  if (by_patch_)
    by_patch_->add_element_jacobian(x, by_element_->material(), A);
  else
    by_element_->add_jacobian(x, VecX(), 1.0, 0.0, A);
}

void CartilageElasticity::add_patch_stress(const VecX& x, std::vector<Mat3>& cauchy_stress) const {
  if (!by_patch_) return;
  const std::vector<Mat3> more = by_patch_->cauchy_stress(x);
  for (std::size_t e = 0; e < more.size(); ++e) cauchy_stress[e] += more[e];
}

}  // namespace coxa::joint
