#pragma once

#include <coxa/mesh/tri_mesh.h>

#include <vector>

namespace coxa {

struct DecimateOptions {
  Index n_triangles = 1000;  ///< >= 4. Wanted; more stay where no edge can go without a fold.
  double evenness = 0.0;     ///< >= 0. 0 follows the shape only; 0.1 gives triangles of even size.
  std::vector<bool> kept = {};  ///< vertices that stay where they are; empty for none
};

/// Fewer triangles: edges are collapsed, cheapest first, each end vertex placed where the squared
/// distance to the planes of the triangles it replaces (and, times `evenness`, to the vertices) is
/// least.
///
/// @param mesh   closed manifold   @returns closed manifold of the same genus
/// @throws Error bad_mesh if the surface is not a closed manifold; bad_input for options out of
/// range Source: Garland and Heckbert 1997; the vertex term is ours.
TriMesh decimate(const TriMesh& mesh, const DecimateOptions& options);

struct RemeshOptions {
  double target_edge = 1.0;  ///< mm, > 0. Edges come out between 4/5 and 4/3 of it, nearly all.
  int iterations = 8;        ///< >= 1
};

/// Even triangles: splits long edges, collapses short ones, flips towards six neighbours per
/// vertex, smooths along the surface and projects onto the input, several times. Sharp edges are
/// rounded to about the edge length.
///
/// @param mesh   closed manifold   @returns closed manifold of the same genus, vertices on the
/// input
/// @throws Error bad_mesh if the surface is not a closed manifold; bad_input for options out of
/// range Source: Botsch and Kobbelt 2004.
TriMesh remesh(const TriMesh& mesh, const RemeshOptions& options);

/// Edge length, mm, at which even triangles covering the area of `mesh` number `n_triangles`.
double edge_length_for(const TriMesh& mesh, Index n_triangles);

}  // namespace coxa
