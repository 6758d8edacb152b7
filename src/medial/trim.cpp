#include <coxa/medial/trim.h>

#include <coxa/medial/face_pair.h>
#include <coxa/medial/sheet_part.h>
#include "sheet_grid.h"
#include "starting_grid.h"

#include <coxa/core/error.h>
#include <coxa/geom/triangle_tree.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kFineEdge = 0.75;  // mm: longest edge where it is decided what goes
constexpr int kRefinements = 6;
constexpr double kSnap = 0.15;   // share of an edge within which a level is moved to its end
constexpr int kSmoothings = 4;   // of the new border
constexpr double kLevel = 1e-9;  // mm

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double thickness(const SheetGrid& grid, const FacePair& faces, Index v) {
  const BallFeet f = grid.rim[at(v)] ? faces.rim_feet(grid.x[at(v)]) : faces.feet(grid.x[at(v)]);
  return (f.first - f.second).norm();
}

std::vector<double> thicknesses(const SheetGrid& grid, const FacePair& faces) {
  std::vector<double> values;
  for (Index v = 0; v < grid.n_nodes(); ++v) values.push_back(thickness(grid, faces, v));
  return values;
}

Vec3 middle_of(const SheetGrid& grid, const FacePair& faces, Index a, Index b) {
  const Vec3 middle = 0.5 * (grid.x[at(a)] + grid.x[at(b)]);
  return grid.on_border(a, b) ? faces.on_rim(middle) : faces.centred(middle);
}

void refine_thin_parts(SheetGrid& grid, const FacePair& faces, double thin) {
  for (int pass = 0; pass < kRefinements; ++pass) {
    const std::vector<double> height = thicknesses(grid, faces);
    std::vector<std::pair<double, std::pair<Index, Index>>> longest;
    for (const auto& [a, b] : grid.edges()) {
      const double length = (grid.x[at(a)] - grid.x[at(b)]).norm();
      if (length > kFineEdge && std::min(height[at(a)], height[at(b)]) < 2.0 * thin)
        longest.push_back({-length, {a, b}});
    }
    if (longest.empty()) return;
    std::sort(longest.begin(), longest.end());
    for (const auto& [length, edge] : longest) {
      if (grid.has_edge(edge.first, edge.second))
        grid.split(edge.first, edge.second, middle_of(grid, faces, edge.first, edge.second));
    }
  }
}

// nodes where `values` pass zero: on edges, or moved to the end of one that is near
void split_at_zero(SheetGrid& grid, std::vector<double>& values) {
  for (const auto& [a, b] : grid.edges()) {
    const double va = values[at(a)], vb = values[at(b)];
    if (va * vb >= 0.0) continue;
    const double share = va / (va - vb);
    if (share < kSnap) {
      values[at(a)] = 0.0;
    } else if (share > 1.0 - kSnap) {
      values[at(b)] = 0.0;
    } else {
      grid.split(a, b, grid.x[at(a)] + share * (grid.x[at(b)] - grid.x[at(a)]));
      values.push_back(0.0);
    }
  }
}

// positive inside zones thick and wide enough
std::vector<double> solidity(const SheetGrid& grid, const FacePair& faces,
                             const TrimOptions& options) {
  std::vector<double> values = thicknesses(grid, faces);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const double from_rim = (faces.on_rim(grid.x[v]) - grid.x[v]).norm();
    values[v] = std::min(values[v] - options.thickness, from_rim - options.width);
  }
  return values;
}

// distances from the cells with no negative value; empty if there are none
std::vector<double> distances_from_solid(const SheetGrid& grid, const std::vector<double>& values) {
  TriMesh solid;
  std::vector<SheetGrid::Cell> cells;
  for (const auto& c : grid.cells()) {
    if (std::all_of(c.begin(), c.end(), [&](Index v) { return values[at(v)] >= 0.0; }))
      cells.push_back(c);
  }
  if (cells.empty()) return {};
  solid.points.resize(grid.n_nodes(), 3);
  for (Index v = 0; v < grid.n_nodes(); ++v) solid.points.row(v) = grid.x[at(v)];
  solid.triangles.resize(static_cast<Eigen::Index>(cells.size()), 3);
  for (std::size_t c = 0; c < cells.size(); ++c)
    solid.triangles.row(static_cast<Eigen::Index>(c)) << cells[c][0], cells[c][1], cells[c][2];
  const TriangleTree tree(solid.points, solid.triangles);
  std::vector<double> distances;
  for (const Vec3& p : grid.x) distances.push_back(std::sqrt(tree.nearest(p).squared_distance));
  return distances;
}

double cell_area(const SheetGrid& grid, const SheetGrid::Cell& c) {
  return 0.5 *
         (grid.x[at(c[1])] - grid.x[at(c[0])]).cross(grid.x[at(c[2])] - grid.x[at(c[0])]).norm();
}

// zones nowhere deeper than `least` are not worth a cut
void spare_shallow_zones(const SheetGrid& grid, std::vector<double>& excess, double least) {
  std::vector<SheetGrid::Cell> beyond;
  for (const auto& c : grid.cells()) {
    if (std::any_of(c.begin(), c.end(), [&](Index v) { return excess[at(v)] > kLevel; }))
      beyond.push_back(c);
  }
  if (beyond.empty()) return;
  const std::vector<Index> piece = sheet_pieces(beyond);
  std::vector<double> deepest(1 + at(*std::max_element(piece.begin(), piece.end())), 0.0);
  for (std::size_t c = 0; c < beyond.size(); ++c)
    for (const Index v : beyond[c])
      deepest[at(piece[c])] = std::max(deepest[at(piece[c])], excess[at(v)]);
  for (std::size_t c = 0; c < beyond.size(); ++c) {
    if (deepest[at(piece[c])] >= least) continue;
    for (const Index v : beyond[c]) excess[at(v)] = std::min(excess[at(v)], 0.0);
  }
}

std::vector<SheetGrid::Cell> kept_cells(const SheetGrid& grid, const std::vector<double>& excess) {
  std::vector<SheetGrid::Cell> kept;
  for (const auto& c : grid.cells()) {
    if (std::all_of(c.begin(), c.end(), [&](Index v) { return excess[at(v)] <= kLevel; }))
      kept.push_back(c);
  }
  std::vector<double> areas;
  for (const auto& c : kept) areas.push_back(cell_area(grid, c));
  const std::vector<char> stays = manifold_part(kept, areas);
  std::vector<SheetGrid::Cell> part;
  for (std::size_t c = 0; c < kept.size(); ++c)
    if (stays[c]) part.push_back(kept[c]);
  return part;
}

// the cut border follows the cells it was cut through: evened along itself
void smooth_cut(SheetGrid& grid, const std::vector<char>& cut, const FacePair& faces) {
  for (int pass = 0; pass < kSmoothings; ++pass) {
    const std::vector<Vec3> before = grid.x;
    for (Index v = 0; v < grid.n_nodes(); ++v) {
      if (!cut[at(v)] || !grid.alive(v)) continue;
      Vec3 sum = Vec3::Zero();
      int count = 0;
      for (const Index u : grid.neighbours(v)) {
        if (!grid.on_border(u, v)) continue;
        sum += before[at(u)];
        ++count;
      }
      if (count == 2) grid.x[at(v)] = faces.centred(0.5 * (before[at(v)] + 0.5 * sum));
    }
  }
}

TrimmedSheet finished(SheetGrid& grid, std::vector<char> cut) {
  TrimmedSheet result;
  const std::vector<Index> number = grid.compact();
  result.cut.assign(grid.x.size(), 0);
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] >= 0) result.cut[at(number[v])] = cut[v];
  result.sheet.points.resize(grid.n_nodes(), 3);
  for (Index v = 0; v < grid.n_nodes(); ++v) result.sheet.points.row(v) = grid.x[at(v)];
  const auto cells = grid.cells();
  result.sheet.triangles.resize(static_cast<Eigen::Index>(cells.size()), 3);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (int k = 0; k < 3; ++k)
      result.sheet.triangles(static_cast<Eigen::Index>(c), k) =
          cells[c][static_cast<std::size_t>(k)];
  return result;
}

// how far what is gone reaches from what is left
double depth_of_cut(const SheetGrid& whole, const TrimmedSheet& left) {
  const TriangleTree tree(left.sheet.points, left.sheet.triangles);
  double squared = 0.0;
  for (const Vec3& p : whole.x) squared = std::max(squared, tree.nearest(p).squared_distance);
  return std::sqrt(squared);
}

}  // namespace

std::optional<TrimmedSheet> trimmed_sheet(const FacePair& faces, const TrimOptions& options) {
  require(options.thickness > 0.0 && options.width >= 0.0 && options.margin > 0.0,
          "trimming: thickness and margin must be > 0 mm, width >= 0 mm, got ", options.thickness,
          ", ", options.margin, ", ", options.width);
  SheetGrid grid = starting_grid(faces);
  refine_thin_parts(grid, faces, options.thickness);
  std::vector<double> values = solidity(grid, faces, options);
  split_at_zero(grid, values);
  std::vector<double> excess = distances_from_solid(grid, values);
  if (excess.empty()) return std::nullopt;
  for (double& value : excess) value -= options.margin;
  split_at_zero(grid, excess);
  spare_shallow_zones(grid, excess, options.least_depth);
  if (*std::max_element(excess.begin(), excess.end()) <= kLevel) return std::nullopt;
  const std::vector<SheetGrid::Cell> kept = kept_cells(grid, excess);
  if (kept.empty()) return std::nullopt;
  double area = 0.0;
  for (const auto& c : grid.cells()) area += cell_area(grid, c);
  for (const auto& c : kept) area -= cell_area(grid, c);
  SheetGrid rest(grid.x, kept);
  std::vector<char> cut(grid.x.size(), 0);
  for (std::size_t v = 0; v < cut.size(); ++v) cut[v] = rest.rim[v] && !grid.rim[v];
  smooth_cut(rest, cut, faces);
  TrimmedSheet result = finished(rest, cut);
  result.area = area;
  result.depth = depth_of_cut(grid, result);
  return result;
}

}  // namespace coxa::medial
