#include "sheet_mesh.h"

#include "cover.h"
#include "crease_snapping.h"
#include "extrude.h"
#include "flips.h"
#include "mending.h"
#include "misses.h"
#include "node_freedom.h"
#include "node_smoothing.h"
#include "sheet_guide.h"
#include "tet_boundary.h"
#include "worst_elements.h"

#include <coxa/core/error.h>
#include <coxa/medial/medial_sheet.h>
#include <coxa/mesh/measures.h>

#include <algorithm>

namespace coxa::meshing {
namespace {

constexpr int kSizeTries = 8;
constexpr double kLeastFilled = 0.5;  // share of the volume: the rest is another body

void improve(TetGrid& grid, const SheetGuide& guide, int rounds, const Monitor& monitor) {
  constexpr int kSnapRound = 2;   // bends of the surface are met once nodes are spread evenly
  constexpr int kMeanRounds = 5;  // first the average, then the worst
  for (int k = 0; k < rounds; ++k) {
    monitor.check_cancelled();
    monitor.progress("improve", static_cast<double>(k) / rounds);
    if (k == kSnapRound) snap_to_creases(grid, guide);
    update_positions(grid, guide, k < kMeanRounds ? 1.0 : 3.0);
  }
  for (int k = 0; k < rounds && raise_worst(grid, guide) > 0; ++k) monitor.check_cancelled();
}

int allowed_tets(const MeshingOptions& options) {
  constexpr int kOneLayer = 20000, kEachLayer = 45000;
  const int layers = options.layers.value_or(1);
  const bool small = layers == 1 || options.order == ElementOrder::ten_node;
  return options.max_tets.value_or(small ? kOneLayer : layers * kEachLayer);
}

// sheet and extrusion of as many elements as allowed, or of as many as the thickness asks for
Extrusion extrude_within(const medial::FacePair& faces, const SlideGuide& guide,
                         const MeshingOptions& options, const Monitor& monitor) {
  constexpr double kWellFilled =
      0.94;  // share of the elements allowed from which it is not tried again
  const int layers = options.layers.value_or(1), max_tets = allowed_tets(options);
  medial::MedialOptions sheet_options{.cell_per_thickness = options.cell_per_thickness / layers};
  sheet_options.knife_edge_rounding = options.rim_rounding;
  sheet_options.max_cells = std::max(8, max_tets / (3 * layers));
  std::optional<Extrusion> best;
  for (int attempt = 0; attempt < kSizeTries; ++attempt) {
    const auto sheet = medial::fit_medial_sheet(faces, sheet_options, monitor);
    Extrusion made = extrude(sheet, guide, layers);
    const double filled = static_cast<double>(made.grid.tets.size()) / max_tets;
    if (filled <= 1.0 && (!best || best->grid.tets.size() < made.grid.tets.size())) {
      best = std::move(made);
    }
    const bool limited = sheet.cells.rows() > sheet_options.max_cells / 2;
    if (filled <= 1.0 && (filled >= kWellFilled || !limited || attempt >= 1)) break;
    sheet_options.max_cells =
        std::max(8, static_cast<int>(0.97 / filled * sheet_options.max_cells));
  }
  if (!best) {
    fail(ErrorCode::below_quality, "no mesh of at most ", max_tets,
         " tetrahedra was found; allow more of them");
  }
  return std::move(*best);
}

// until no element is inverted: by moving nodes, or where the sheet is crumpled by dropping cells
void bring_back_inverted(Extrusion& made, const SlideGuide& guide, MeshingReport& report) {
  constexpr int kTries = 6;
  Index inverted = untangle(made.grid, guide), dropped = 0;
  for (int k = 0; inverted > 0; ++k) {
    inverted = untangle_freely(made.grid, guide);
    if (inverted == 0) break;
    if (k == kTries || 20 * dropped > static_cast<Index>(made.cells.size()))
      fail(ErrorCode::below_quality, inverted, " elements stay inverted");
    dropped = drop_inverted_cells(made);
    inverted = count_inverted(made.grid);
  }
  if (dropped > 0)
    report.notes.push_back(
        join_text(dropped, " crumpled cells were left out, of ", made.cells.size()));
}

// A grid far from filling the body, or that misses the surface by more than cartilage is thick, is
// not worth improving where another method may be taken.
void check_worth_improving(const TetGrid& grid, const TriMesh& surface,
                           const MeshingOptions& options) {
  constexpr double kFarOff = 4.0;  // mm
  if (options.method != Method::automatic || options.layers || options.max_tets) return;
  if (const double envelope = envelope_error(boundary_surface(grid), surface); envelope > kFarOff)
    fail(ErrorCode::below_quality, "the medial grid misses the surface by ", envelope, " mm");
}

// ridges and tips that are cut off; flips and splits would leave the layers asked for
void cover_and_raise(TetGrid& grid, const TriMesh& surface, const SlideGuide& guide,
                     const MeshingOptions& options) {
  constexpr int kRounds = 3;
  for (int k = 0; k < kRounds; ++k) {
    const std::ptrdiff_t room = options.layers ? 0 : allowed_tets(options) - grid.n_living();
    if (cover_far_places(grid, surface, {.room = room}) == 0) break;
    if (!options.layers)
      flip_poor(grid, guide, {.below = 0.35, .max_tets = allowed_tets(options), .collapse = false});
    raise_worst(grid, guide);
  }
  if (has_poor_element(grid)) raise_freely(grid, guide);
}

}  // namespace

MeshingResult mesh_sheet(const TriMesh& surface, const medial::SurfaceSides& sides,
                         const MeshingOptions& options, const Monitor& monitor) {
  MeshingResult result;
  medial::FacePair faces(surface, sides);
  if (const auto trimmed = medial::trimmed_sheet(faces)) {
    faces.update_rim(*trimmed);
    result.report.notes.push_back(
        join_text("border zones too thin or narrow to be filled were cut away: ", trimmed->area,
                  " mm², the border moved by up to ", trimmed->depth, " mm"));
  }
  const SheetGuide guide(surface, sides, faces, options.rim_rounding);
  Extrusion made = extrude_within(faces, guide, options, part_of(monitor, "medial grid", 0.0, 0.6));
  bring_back_inverted(made, guide, result.report);
  check_worth_improving(made.grid, surface, options);
  improve(made.grid, guide, options.improvement_rounds, part_of(monitor, "improve", 0.6, 1.0));
  if (!options.layers && options.improvement_rounds > 0) {
    for (int k = 0; k < 3; ++k) {
      flip_poor(made.grid, guide, {.below = 0.5, .max_tets = allowed_tets(options)});
      update_positions(made.grid, guide, 2.0);
    }
  }
  if (options.improvement_rounds > 0) raise_freely(made.grid, guide);
  draw_back(made.grid, guide);
  if (options.improvement_rounds > 0) cover_and_raise(made.grid, surface, guide, options);
  const Index dropped = drop_poor_elements(made.grid);
  if (dropped > 0) {
    result.report.notes.push_back(
        join_text(dropped, " poor elements at the boundary were dropped"));
  }
  if (const double departure = largest_departure(made.grid, guide, surface); departure > 1e-3) {
    result.report.notes.push_back(
        join_text("nodes left the surface by up to ", departure, " mm to make elements better"));
  }
  result.report.method = Method::medial;
  result.report.sheetness = sides.sheetness;
  result.report.layers = options.layers.value_or(1);
  result.report.rim_rounding = guide.largest_rounding();
  result.report.envelope = envelope_error(boundary_surface(made.grid), surface);
  result.mesh = to_tet_mesh(made.grid);
  result.report.quality = tet_quality(result.mesh.points, result.mesh.tets);
  if (const double share = result.report.quality.volume / volume(surface); share < kLeastFilled)
    fail(ErrorCode::below_quality, "the medial grid fills only ", 100.0 * share, " % of the body");
  return result;
}

}  // namespace coxa::meshing
