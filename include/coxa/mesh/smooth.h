#pragma once

#include <coxa/mesh/tri_mesh.h>

namespace coxa {

struct SmoothOptions {
  int iterations = 10;  ///< >= 0
  double lambda = 0.5;  ///< in [0, 1]: share of the way to the mean of the neighbours
  double mu = -0.53;  ///< in [-1, 0]: the step back that undoes shrinking; 0 gives plain Laplacian
                      ///< smoothing
};

/// Smoothed vertices: alternating steps towards and away from the mean of the neighbours. Border
/// vertices stay. Source: Taubin 1995.
TriMesh smoothed(const TriMesh& mesh, const SmoothOptions& options = {});

}  // namespace coxa
