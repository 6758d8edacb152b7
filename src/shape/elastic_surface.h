#pragma once

#include <coxa/mesh/topology.h>
#include <coxa/mesh/tri_mesh.h>

namespace coxa::shape {

/// A surface whose pieces resist any change but rotation and uniform growth: as-rigid-as-possible
/// edges (Sorkine and Alexa 2007), with a size per vertex.
class ElasticSurface {
 public:
  /// @param rest shape without strain, mm
  explicit ElasticSurface(const TriMesh& rest);

  /// Positions that minimise sum w |x - target|² + (length / edge)² sum |x_i - x_j - M (p_i -
  /// p_j)|² over the edges; M, the mean of the similarities of both ends, is taken from `current`.
  ///
  /// @param weights V, >= 0, not all 0   @param length mm, over which a single pull is felt
  Points relaxed(const Points& current, const Points& targets, const VecX& weights,
                 double length) const;

 private:
  std::vector<Mat3> local_similarities(const Points& current) const;

  Points rest_;
  Adjacency neighbours_;
  double edge_ = 1.0;  ///< mm, mean
};

}  // namespace coxa::shape
