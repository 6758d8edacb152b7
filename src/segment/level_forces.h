#pragma once

#include <coxa/segment/body.h>
#include <coxa/segment/evolve.h>
#include <coxa/segment/mesh_forces.h>

#include <vector>

namespace coxa::segment {

/// The particles and forces of one body at one level; `prepare` refreshes the forces' targets.
class LevelForces {
 public:
  /// @param first number of the body's first particle
  LevelForces(const Body& body, std::size_t level, Index first);

  Index n() const { return mesh_.n_vertices(); }
  Index first() const { return first_; }
  const SimplexMesh& mesh() const { return mesh_; }
  std::vector<const dynamics::Force*> forces() const;

  /// @param positions  n×3 of the level   @param field V×3 displacement asked for at the finest
  /// vertices
  void prepare(const Body& body, const Points& positions, const Points& field,
               const ForceWeights& weights, const TriMesh& host, double seat_gap);

 private:
  void prepare_internal(const Points& fit, const ForceWeights& weights);
  void prepare_seat(const Body& body, const Points& normals, const ForceWeights& weights,
                    const TriMesh& host, double seat_gap);

  std::size_t level_;
  Index first_;
  SimplexMesh mesh_;
  TargetForce image_, shape_, seat_;
  SimplexForce smoothing_, memory_;
};

}  // namespace coxa::segment
