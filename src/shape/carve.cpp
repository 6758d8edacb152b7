#include <coxa/shape/carve.h>

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/rebuild.h>
#include <coxa/mesh/sample_grid.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/voxelize.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace coxa::shape {
namespace {

// grid spacings: farther from a surface only the side counts
constexpr double kBand = 4.0;

SampleGrid grid_around(const TriMesh& mesh, double h) {
  const Bounds box = bounds(mesh.points);
  SampleGrid grid;
  grid.spacing = h;
  // a third of a cell off the corner: samples then rarely lie on flat faces
  grid.origin = box.low.array() - 1.33 * h;
  for (int k = 0; k < 3; ++k)
    grid.size[static_cast<std::size_t>(k)] =
        static_cast<Index>(std::ceil((box.high[k] - grid.origin[k]) / h)) + 2;
  return grid;
}

std::vector<std::uint8_t> inside(const TriMesh& mesh, const SampleGrid& grid) {
  return inside_samples(mesh, grid.size, [&](const Vec3& p) { return grid.index(p); });
}

/// Distance into the surface, negative outside, no more than the band to either side.
std::vector<float> depths(const TriMesh& mesh, const SampleGrid& grid) {
  const auto within = inside(mesh, grid);
  const TriangleTree tree(mesh.points, mesh.triangles);
  const double band = kBand * grid.spacing;
  std::vector<float> values(within.size());
  grid.for_samples([&](std::size_t n, const Vec3& p) {
    const auto near = tree.nearest_within(p, band);
    const double distance = near ? std::sqrt(near->squared_distance) : band;
    values[n] = static_cast<float>(within[n] != 0 ? distance : -distance);
  });
  return values;
}

/// Lowers the depths to the distance from the obstacle less the gap. @returns whether any was
bool lower(const TriMesh& obstacle, double gap, const SampleGrid& grid,
           std::vector<float>& values) {
  const TriangleTree tree(obstacle.points, obstacle.triangles);
  const auto within = inside(obstacle, grid);
  const double band = kBand * grid.spacing;
  std::vector<char> lowered(values.size(), 0);
  grid.for_samples([&](std::size_t n, const Vec3& p) {
    if (values[n] < -0.99 * band) return;
    const auto near = tree.nearest_within(p, band);
    if (!near && within[n] == 0) return;
    const double distance = near ? std::sqrt(near->squared_distance) : band;
    const auto room = static_cast<float>((within[n] != 0 ? -distance : distance) - gap);
    if (room >= values[n]) return;
    lowered[n] = values[n] > 0.0F;
    values[n] = room;
  });
  return std::any_of(lowered.begin(), lowered.end(), [](char c) { return c != 0; });
}

struct Piece {
  TriMesh mesh;
  double share = 0.0;  ///< of all pieces' volume
};

/// The largest piece, unless all are wanted.
Piece wanted_piece(TriMesh mesh, const CarveOptions& options) {
  if (options.least_whole == 0.0) return {std::move(mesh), 1.0};
  const std::vector<Index> piece = triangle_components(mesh);
  Index largest = 0;
  piece_areas(mesh, piece).maxCoeff(&largest);
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t)
    if (piece[static_cast<std::size_t>(t)] == largest) kept.push_back(t);
  TriMesh one = sub_mesh(mesh, kept).mesh;
  const double share = volume(one) / volume(mesh);
  return {std::move(one), share};
}

/// Even triangles. Rims sharper than the grid would fold, so they are rounded, but no more than
/// leaves it in one piece.
Piece even_piece(const TriMesh& raw, const CarveOptions& options) {
  Piece best;
  for (const double opening : {1.0, 0.5, 0.25}) {
    Piece piece =
        wanted_piece(rebuild(raw, {.spacing = options.spacing,
                                   .opening = opening * options.rounding * options.spacing,
                                   .target_edge = options.edge,
                                   .max_move = kInfinity})
                         .mesh,
                     options);
    if (piece.share > best.share) best = std::move(piece);
    if (best.share >= options.least_whole) break;
  }
  return best;
}

}  // namespace

TriMesh carved(const TriMesh& mesh, const std::vector<const TriMesh*>& obstacles,
               const CarveOptions& options) {
  require(
      options.gap >= 0.0 && options.spacing > 0.0 && options.edge > 0.0 && options.rounding > 0.0,
      "gap, spacing, edge and rounding of a carved surface must be positive");
  require(options.least_kept > 0.0 && options.least_kept <= 1.0,
          "least_kept must be in (0, 1], got ", options.least_kept);
  require(options.least_whole >= 0.0 && options.least_whole <= 1.0,
          "least_whole must be in [0, 1], got ", options.least_whole);
  const SampleGrid grid = grid_around(mesh, options.spacing);
  std::vector<float> values = depths(mesh, grid);
  bool any = false;
  for (const TriMesh* obstacle : obstacles)
    any = lower(*obstacle, options.gap, grid, values) || any;
  if (!any && !options.anew) return mesh;
  const bool left = std::any_of(values.begin(), values.end(), [](float v) { return v > 0.0F; });
  if (!left) fail(ErrorCode::below_quality, "nothing of it lies out of everything else");
  const TriMesh raw =
      iso_surface(grid.size, values, 0.0, [&](const Vec3& index) { return grid.position(index); });
  const double kept = volume(raw) / volume(mesh);
  Piece piece;
  if (kept >= options.least_kept) piece = even_piece(raw, options);
  if (kept < options.least_kept || piece.share < options.least_whole)
    fail(ErrorCode::below_quality, "what lies out of everything else is ",
         std::lround(100.0 * kept), " % of the volume, ", std::lround(100.0 * piece.share),
         " % of that in one piece");
  return piece.mesh;
}

}  // namespace coxa::shape
