#include <coxa/meshing/mesh_surface.h>

#include "element_shape.h"
#include "extrude.h"
#include "node_smoothing.h"
#include "tet_boundary.h"

#include <coxa/core/error.h>
#include <coxa/medial/medial_sheet.h>
#include <coxa/mesh/topology.h>

#include <algorithm>
#include <cmath>

namespace coxa::meshing {
namespace {

// below this share of facing area a body is no sheet
constexpr double kSheet = 0.7;
constexpr int kSizeTries = 6;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

void check(const MeshingOptions& o) {
  require(!o.layers || (*o.layers >= 1 && *o.layers <= 8), "layers must be 1 to 8, got ",
          o.layers.value_or(0));
  require(o.max_tets > 100, "max_tets must be above 100, got ", o.max_tets);
  require(o.cell_per_thickness > 0, "cell_per_thickness must be > 0, got ", o.cell_per_thickness);
  require(o.rim_rounding >= 0 && o.rim_rounding <= 0.25,
          "rim_rounding must be in [0, 0.25] mm, got ", o.rim_rounding);
  require(o.improvement_rounds >= 0, "improvement_rounds must be >= 0, got ", o.improvement_rounds);
}

void update_figures(const TetGrid& grid, MeshingReport& report) {
  std::vector<double> aspects;
  double smallest = kPi, largest = 0.0, sum = 0.0;
  for (const Tet& t : grid.tets) {
    const Vec3 &a = grid.x[at(t[0])], &b = grid.x[at(t[1])], &c = grid.x[at(t[2])],
               &d = grid.x[at(t[3])];
    aspects.push_back(aspect_ratio(a, b, c, d));
    sum += aspects.back();
    const DihedralRange range = dihedral_range(a, b, c, d);
    smallest = std::min(smallest, range.smallest);
    largest = std::max(largest, range.largest);
  }
  std::sort(aspects.begin(), aspects.end());
  report.aspect_mean = sum / static_cast<double>(aspects.size());
  report.aspect_p05 = aspects[aspects.size() / 20];
  report.aspect_min = aspects.front();
  report.dihedral_min = smallest;
  report.dihedral_max = largest;
}

void improve(TetGrid& grid, const SlideGuide& guide, int rounds, const Monitor& monitor) {
  constexpr int kMeanRounds = 5;  // first the average, then the worst
  for (int k = 0; k < rounds; ++k) {
    monitor.check_cancelled();
    monitor.progress("improve", static_cast<double>(k) / rounds);
    update_positions(grid, guide, k < kMeanRounds ? 1.0 : 3.0);
  }
}

MeshingResult mesh_sheet(const TriMesh& surface, const medial::SurfaceSides& sides,
                         const MeshingOptions& options, const Monitor& monitor) {
  const int layers = options.layers.value_or(1);
  const medial::FacePair faces(surface, sides);
  const SlideGuide guide(surface, sides, faces, options.rim_rounding);
  medial::MedialOptions sheet_options{.cell_per_thickness = options.cell_per_thickness / layers};
  sheet_options.max_cells = std::max(8, options.max_tets / (3 * layers));
  for (int attempt = 0; attempt < kSizeTries; ++attempt) {
    const auto sheet = medial::fit_medial_sheet(surface, sides, sheet_options,
                                                part_of(monitor, "medial grid", 0.0, 0.5));
    Extrusion made = extrude(sheet, guide, layers);
    const int n_tets = static_cast<int>(made.grid.tets.size());
    if (n_tets > options.max_tets) {
      const double share = 0.95 * options.max_tets / n_tets;
      sheet_options.max_cells = std::max(8, static_cast<int>(share * sheet_options.max_cells));
      continue;
    }
    const Index inverted = untangle(made.grid, guide);
    if (inverted > 0) fail(ErrorCode::below_quality, inverted, " elements stay inverted");
    improve(made.grid, guide, options.improvement_rounds, part_of(monitor, "improve", 0.5, 1.0));
    MeshingResult result;
    result.report.method = Method::medial;
    result.report.sheetness = sides.sheetness;
    result.report.layers = layers;
    result.report.rim_rounding = guide.largest_rounding();
    update_figures(made.grid, result.report);
    result.mesh = to_tet_mesh(made.grid);
    return result;
  }
  fail(ErrorCode::below_quality, "no mesh of at most ", options.max_tets,
       " tetrahedra was found; allow more of them");
}

}  // namespace

MeshingResult mesh_surface(const TriMesh& surface, const MeshingOptions& options,
                           const Monitor& monitor) {
  check(options);
  require_closed_manifold(surface, "surface to fill with tetrahedra");
  const medial::SurfaceSides sides = medial::split_sides(surface);
  if (sides.sheetness < kSheet) {
    fail(ErrorCode::bad_mesh, "the body is no sheet: only ", 100.0 * sides.sheetness,
         " % of its surface faces another part of it across the body");
  }
  return mesh_sheet(surface, sides, options, monitor);
}

}  // namespace coxa::meshing
