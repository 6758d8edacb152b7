#pragma once

#include <coxa/fem/sphere_contact.h>
#include <coxa/mesh/tet_mesh.h>

#include <array>
#include <functional>
#include <vector>

#include "fem/shapes.h"

namespace coxa::verify {

/// A grid of cells, each cut into six tets, with nodes in the middle of their edges; node (i, j, k)
/// of the grid is placed by `position`. Cells that `position` flattens lose their flat tets and
/// doubled nodes (a wedge's axis).
struct Grid {
  Index nx, ny, nz;
  std::function<Vec3(Index, Index, Index)> position;
};

/// Ten-node mesh of the grid.
TetMesh quadratic_mesh(const Grid& grid);

/// The four-node mesh of the corners of a ten-node mesh, whose corners come first.
TetMesh corners_only(const TetMesh& mesh);

/// Faces of the mesh, as six nodes each, all of whose nodes satisfy `on_surface`.
fem::ContactFaces faces_where(const TetMesh& mesh,
                              const std::function<bool(const Vec3&)>& on_surface);

/// A body of revolution about z, standing for the whole as the sector between the planes at
/// -angle/2 and angle/2.
struct Sector {
  TetMesh mesh;
  double angle;
  /// Whole over sector: the circle over the polygon's slice.
  double multiplicity() const;
};
/// @param r, z  grid lines, r[0] = 0
Sector make_sector(const std::vector<double>& r, const std::vector<double>& z, double angle);

/// n+1 values from 0 to `end`, steps growing by `growth` each.
std::vector<double> graded(double end, int n, double growth);

}  // namespace coxa::verify
