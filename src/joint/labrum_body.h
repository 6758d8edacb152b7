#pragma once

#include <coxa/joint/joint_model.h>

#include <vector>

#include "elasticity.h"

namespace coxa::joint {

/// Nodes of the labrum that the hip bone holds: those of its bone side, or where it has no facet
/// tagged so, those as near to the hip bone as a seat. Ascending.
std::vector<Index> labrum_seat(const JointModel& model);

/// The labrum as an elastic body whose node i is particle first + i.
class LabrumBody {
 public:
  /// @note keeps a reference to the model, which must outlive it
  LabrumBody(const JointModel& model, Index first);

  Index first() const { return first_; }
  Index n_nodes() const { return model_.labrum_body.n_vertices(); }
  const std::vector<Index>& held() const { return held_; }  ///< particles
  /// Boundary facets that may touch the femur, of particles: all with a free node.
  const Triangles& surface() const { return surface_; }
  const CartilageElasticity& elasticity() const { return elasticity_; }

 private:
  const JointModel& model_;
  Index first_;
  std::vector<Index> held_;
  Triangles surface_;
  CartilageElasticity elasticity_;
};

}  // namespace coxa::joint
