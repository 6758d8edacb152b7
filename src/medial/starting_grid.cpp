#include "starting_grid.h"

namespace coxa::medial {

void update_centred(SheetGrid& grid, const FacePair& faces) {
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    if (!grid.alive(v)) continue;
    Vec3& p = grid.x[static_cast<std::size_t>(v)];
    p = grid.rim[static_cast<std::size_t>(v)] ? faces.on_rim(p) : faces.centred(p);
  }
}

SheetGrid starting_grid(const FacePair& faces) {
  const TriMesh& sheet = faces.start();
  std::vector<Vec3> nodes;
  for (Index v = 0; v < sheet.n_vertices(); ++v) nodes.emplace_back(sheet.points.row(v));
  std::vector<SheetGrid::Cell> cells;
  for (Index t = 0; t < sheet.n_triangles(); ++t)
    cells.push_back({sheet.triangles(t, 0), sheet.triangles(t, 1), sheet.triangles(t, 2)});
  SheetGrid grid(std::move(nodes), cells);
  update_centred(grid, faces);
  return grid;
}

}  // namespace coxa::medial
