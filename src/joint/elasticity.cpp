#include "elasticity.h"

#include <numeric>

namespace coxa::joint {
namespace {

std::unique_ptr<fem::Material> make_law(const CartilageMaterial& material) {
  const fem::Lame lame = fem::lame_from(material.youngs_modulus, material.poissons_ratio);
  return material.law == MaterialLaw::corotational ? fem::make_corotational(lame)
                                                   : fem::make_st_venant_kirchhoff(lame);
}

}  // namespace

std::unique_ptr<fem::ElasticForce> make_elasticity(const TetMesh& mesh, Index first_particle,
                                                   const CartilageMaterial& material) {
  fem::ParticleMap map;
  map.particle_of.resize(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(map.particle_of.begin(), map.particle_of.end(), first_particle);
  return std::make_unique<fem::ElasticForce>(
      mesh, make_law(material), std::move(map),
      fem::ElasticOptions{.axes = {}, .tangent = fem::Tangent::positive});
}

}  // namespace coxa::joint
