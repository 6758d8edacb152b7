#include <coxa/collide/particle_surface.h>

#include <coxa/core/error.h>
#include <coxa/mesh/topology.h>

#include <algorithm>

namespace coxa::collide {

ParticleSurface make_particle_surface(const Triangles& triangles) {
  if (triangles.rows() == 0) fail(ErrorCode::bad_mesh, "contact surface has no triangle");
  if (triangles.minCoeff() < 0)
    fail(ErrorCode::bad_mesh, "contact surface names a negative particle");

  ParticleSurface surface;
  surface.particle.assign(triangles.data(), triangles.data() + triangles.size());
  std::sort(surface.particle.begin(), surface.particle.end());
  surface.particle.erase(std::unique(surface.particle.begin(), surface.particle.end()),
                         surface.particle.end());
  surface.weight.assign(surface.particle.size(), 1.0);
  surface.row_start.resize(surface.particle.size() + 1);
  for (std::size_t v = 0; v < surface.row_start.size(); ++v) {
    surface.row_start[v] = static_cast<Index>(v);
  }
  surface.triangles = triangles.unaryExpr([&](Index particle) {
    const auto at = std::lower_bound(surface.particle.begin(), surface.particle.end(), particle);
    return static_cast<Index>(at - surface.particle.begin());
  });
  return surface;
}

ParticleSurface make_particle_surface(const SimplexMesh& mesh, Index first_particle) {
  // members of every face, in ascending vertex order
  std::vector<std::vector<Index>> members(static_cast<std::size_t>(mesh.n_faces));
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    for (int k = 0; k < 3; ++k) members[static_cast<std::size_t>(mesh.faces_of(v, k))].push_back(v);
  }
  ParticleSurface surface;
  surface.triangles = fan_surface(mesh).triangles;
  surface.row_start.push_back(0);
  const auto close_row = [&] {
    surface.row_start.push_back(static_cast<Index>(surface.particle.size()));
  };
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    surface.particle.push_back(first_particle + v);
    surface.weight.push_back(1.0);
    close_row();
  }
  for (const std::vector<Index>& face : members) {
    for (const Index v : face) {
      surface.particle.push_back(first_particle + v);
      surface.weight.push_back(1.0 / static_cast<double>(face.size()));
    }
    close_row();
  }
  return surface;
}

Points surface_points(const ParticleSurface& surface, const VecX& x) {
  Points points = Points::Zero(surface.n_vertices(), 3);
  for (Index v = 0; v < surface.n_vertices(); ++v) {
    const auto first = static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(v)]);
    const auto last = static_cast<std::size_t>(surface.row_start[static_cast<std::size_t>(v) + 1]);
    for (std::size_t k = first; k < last; ++k) {
      points.row(v) += surface.weight[k] * x.segment<3>(3 * surface.particle[k]).transpose();
    }
  }
  return points;
}

Triangles edge_neighbours(const Triangles& triangles) {
  const MeshEdges edges = mesh_edges({Points::Zero(triangles.maxCoeff() + 1, 3), triangles});
  Triangles neighbours = Triangles::Constant(triangles.rows(), 3, -1);
  for (Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      for (const Index other : edges.triangles[edges.of_triangle(t, k)]) {
        if (other == t) continue;
        neighbours(t, k) = other;
        break;
      }
    }
  }
  return neighbours;
}

}  // namespace coxa::collide
