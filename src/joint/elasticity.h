#pragma once

#include <coxa/fem/elastic_force.h>
#include <coxa/joint/joint_model.h>

#include <memory>

namespace coxa::joint {

/// Elastic force of a cartilage whose node i is particle first_particle + i; its Jacobian is
/// positive semidefinite, so that every Newton step goes downhill.
std::unique_ptr<fem::ElasticForce> make_elasticity(const TetMesh& mesh, Index first_particle,
                                                   const CartilageMaterial& material);

}  // namespace coxa::joint
