#include <coxa/meshing/mesh_surface.h>

#include "limits.h"
#include "mid_nodes.h"
#include "sheet_mesh.h"
#include "solid_mesh.h"

#include <coxa/core/error.h>
#include <coxa/mesh/topology.h>

#include <algorithm>
#include <utility>

namespace coxa::meshing {
namespace {

// below this share of facing area a body is no sheet
constexpr double kSheet = 0.7;
// above this thickness relative to the width of a face a body is no sheet
constexpr double kThick = 0.35;

void check(const MeshingOptions& o) {
  require(!o.layers || (*o.layers >= 1 && *o.layers <= 8), "layers must be 1 to 8, got ",
          o.layers.value_or(0));
  require(o.max_tets.value_or(101) > 100, "max_tets must be above 100, got ",
          o.max_tets.value_or(0));
  require(o.cell_per_thickness > 0, "cell_per_thickness must be > 0, got ", o.cell_per_thickness);
  require(o.rim_rounding >= 0 && o.rim_rounding <= 0.25,
          "rim_rounding must be in [0, 0.25] mm, got ", o.rim_rounding);
  require(o.improvement_rounds >= 0, "improvement_rounds must be >= 0, got ", o.improvement_rounds);
}

SheetLikeness likeness_of(double sheetness, double relative_thickness) {
  SheetLikeness result{sheetness, relative_thickness, ""};
  if (sheetness < kSheet || relative_thickness > kThick)
    result.why_not = join_text("the body is no sheet: ", 100.0 * sheetness,
                               " % of its surface faces another part of it, at ",
                               relative_thickness, " times the width of a face");
  return result;
}

struct Sheet {
  SheetLikeness likeness;
  medial::SurfaceSides sides;  // empty where the bound says that the body is no sheet
};

Sheet sheet_of(const TriMesh& surface) {
  const medial::FacingBound bound = medial::facing_bound(surface);
  Sheet sheet{likeness_of(bound.sheetness, bound.relative_thickness), {}};
  if (!sheet.likeness.is_sheet()) return sheet;
  sheet.sides = medial::split_sides(surface);
  sheet.likeness = likeness_of(sheet.sides.sheetness, sheet.sides.relative_thickness);
  return sheet;
}

MeshingResult solid_because(const std::string& why, const SheetLikeness& likeness,
                            const TriMesh& surface, const MeshingOptions& options,
                            const Monitor& monitor) {
  MeshingResult result = mesh_solid(surface, options, monitor);
  result.report.sheetness = likeness.sheetness;
  result.report.notes.insert(result.report.notes.begin(),
                             join_text("filled from a lattice, since ", why));
  return result;
}

// four-node elements by the method asked for, or by the one that fits
MeshingResult straight_mesh(const TriMesh& surface, const MeshingOptions& options,
                            const Monitor& monitor) {
  if (options.method == Method::lattice) return mesh_solid(surface, options, monitor);
  const auto [likeness, sides] = sheet_of(surface);
  const bool may_choose = options.method == Method::automatic;
  if (!likeness.is_sheet()) {
    if (!may_choose) fail(ErrorCode::bad_mesh, likeness.why_not);
    return solid_because(likeness.why_not, likeness, surface, options, monitor);
  }
  try {
    MeshingResult sheet = mesh_sheet(surface, sides, options, monitor);
    if (!may_choose || options.layers || options.max_tets || meets_limits(sheet.report))
      return sheet;
    MeshingResult solid = solid_because(
        join_text("the medial grid gave a mean aspect ratio of ", sheet.report.quality.aspect_mean,
                  " and an envelope error of ", sheet.report.envelope, " mm"),
        likeness, surface, options, monitor);
    return nearer_to_limits(solid.report, sheet.report) ? solid : sheet;
  } catch (const Error& error) {
    if (!may_choose || error.code() == ErrorCode::cancelled) throw;
    MeshingResult solid = solid_because(join_text("the medial grid failed: ", error.what()),
                                        likeness, surface, options, monitor);
    solid.report.medial_failed = true;
    return solid;
  }
}

void add_mid_nodes(const TriMesh& surface, MeshingResult& result) {
  const TriangleTree tree(surface.points, surface.triangles);
  const MidNodeReport made = update_to_ten_nodes(result.mesh, tree);
  result.report.least_jacobian = made.least_ratio;
  if (made.n_relaxed > 0)
    result.report.notes.push_back(
        join_text(made.n_relaxed, " of ", made.n_curved,
                  " mid-edge nodes at the boundary were drawn back to keep elements valid"));
}

}  // namespace

SheetLikeness sheet_likeness(const TriMesh& surface) {
  require_closed_manifold(surface, "surface to fill with tetrahedra");
  return sheet_of(surface).likeness;
}

MeshingResult mesh_surface(const TriMesh& surface, const MeshingOptions& options,
                           const Monitor& monitor) {
  check(options);
  require_closed_manifold(surface, "surface to fill with tetrahedra");
  MeshingResult result = straight_mesh(surface, options, monitor);
  if (options.order == ElementOrder::ten_node) add_mid_nodes(surface, result);
  return result;
}

}  // namespace coxa::meshing
