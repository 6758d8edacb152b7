#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/simplex_mesh.h>

#include <vector>

namespace coxa::collide {

/// Triangle surface carried by particles: vertex v lies at sum of weight[k] x[particle[k]], with k
/// in [row_start[v], row_start[v+1]).
///
/// Most vertices are a particle themselves; the face centres of a simplex mesh are means of
/// several.
struct ParticleSurface {
  Triangles triangles;           ///< T×3 vertex numbers, counter-clockwise seen from outside
  std::vector<Index> row_start;  ///< V+1
  std::vector<Index> particle;
  std::vector<double> weight;  ///< the weights of a vertex sum to 1

  Index n_vertices() const { return static_cast<Index>(row_start.size()) - 1; }
  Index n_triangles() const { return static_cast<Index>(triangles.rows()); }
};

/// Surface whose vertices are the particles that `triangles` name, renumbered in ascending order.
///
/// @param triangles T×3 particle numbers, for example boundary facets of a tetrahedral mesh
/// @throws Error bad_mesh if there is no triangle or a number is negative
ParticleSurface make_particle_surface(const Triangles& triangles);

/// The fan triangulation of a simplex mesh whose vertex i is particle first_particle + i.
ParticleSurface make_particle_surface(const SimplexMesh& mesh, Index first_particle);

/// Vertex positions, V×3 mm, for particle positions x (3n values).
Points surface_points(const ParticleSurface& surface, const VecX& x);

/// The triangle on the other side of each of the three edges of each triangle (edge k joins corners
/// k and k+1), -1 where there is none; the lowest of them where there are several.
Triangles edge_neighbours(const Triangles& triangles);

}  // namespace coxa::collide
