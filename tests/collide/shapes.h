#pragma once

#include <coxa/core/rng.h>
#include <coxa/mesh/tri_mesh.h>

#include "support/shapes.h"

namespace coxa::test {

/// Particle positions (3n values) of the meshes' vertices, one mesh after the other.
inline VecX stacked(const TriMesh& a, const TriMesh& b = {}) {
  VecX x(3 * (a.n_vertices() + b.n_vertices()));
  for (Index v = 0; v < a.n_vertices(); ++v) x.segment<3>(3 * v) = a.points.row(v).transpose();
  for (Index v = 0; v < b.n_vertices(); ++v) {
    x.segment<3>(3 * (a.n_vertices() + v)) = b.points.row(v).transpose();
  }
  return x;
}

/// The triangles of b as particle numbers when b is stacked after a.
inline Triangles after(const TriMesh& a, const TriMesh& b) {
  return (b.triangles.array() + a.n_vertices()).matrix();
}

/// x with every value moved by a normal deviate of `deviation`.
inline VecX shaken(VecX x, double deviation) {
  Rng rng(7);
  for (double& value : x) value += deviation * rng.normal();
  return x;
}

}  // namespace coxa::test
