#include <coxa/medial/medial_sheet.h>

#include <coxa/medial/face_pair.h>
#include "cell_sizing.h"
#include "sheet_grid.h"
#include "starting_grid.h"

#include <coxa/core/error.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kSplit = 4.0 / 3.0;     // edges longer than this times the wanted length are split
constexpr double kCollapse = 4.0 / 5.0;  // and shorter ones collapsed (Botsch and Kobbelt 2004)
constexpr double kTiny = 0.4;            // the same once cells are only evened
constexpr double kCornerShare = 0.1;     // of a cell: height from which a border bend is a corner
constexpr double kSmallestCorner = 0.06;  // mm
constexpr double kRelax = 0.8;            // share of the step to the weighted centre

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

void check(const MedialOptions& o) {
  require(o.cell_per_thickness > 0, "cell_per_thickness must be > 0, got ", o.cell_per_thickness);
  require(o.smallest_cell >= 0, "smallest_cell must be >= 0 mm, got ", o.smallest_cell);
  require(o.largest_cell > 0 && o.largest_cell >= o.smallest_cell,
          "largest_cell must be > 0 mm and not below smallest_cell, got ", o.largest_cell);
  require(o.gradation > 0, "gradation must be > 0, got ", o.gradation);
  require(o.knife_edge_rounding >= 0, "knife_edge_rounding must be >= 0 mm, got ",
          o.knife_edge_rounding);
  require(o.blunt_angle > 0, "blunt_angle must be > 0 rad, got ", o.blunt_angle);
  require(o.chord_error > 0, "chord_error must be > 0 mm, got ", o.chord_error);
  require(o.max_cells >= 8, "max_cells must be >= 8, got ", o.max_cells);
  require(o.iterations >= 1, "iterations must be >= 1, got ", o.iterations);
}

// pins border nodes that a chord between the border half a cell before and after would miss by far
void pin_corners(SheetGrid& grid, const FacePair& faces) {
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    if (!grid.rim[at(v)]) continue;
    const auto [before, after] = faces.rim().around(grid.x[at(v)], 0.5 * grid.size[at(v)]);
    const Vec3 chord = after - before;
    if (chord.norm() <= 0.0) continue;
    const Vec3 offset = grid.x[at(v)] - before;
    const double height = (offset - chord * (chord.dot(offset) / chord.squaredNorm())).norm();
    grid.pinned[at(v)] = height > std::max(kCornerShare * grid.size[at(v)], kSmallestCorner);
  }
}

double relative_length(const SheetGrid& grid, Index a, Index b) {
  return (grid.x[at(a)] - grid.x[at(b)]).norm() / (0.5 * (grid.size[at(a)] + grid.size[at(b)]));
}

std::vector<std::pair<Index, Index>> edges_by_length(const SheetGrid& grid, bool longest_first) {
  auto edges = grid.edges();
  std::vector<std::pair<double, std::pair<Index, Index>>> keyed;
  for (const auto& e : edges) {
    const double length = relative_length(grid, e.first, e.second);
    keyed.emplace_back(longest_first ? -length : length, e);
  }
  std::sort(keyed.begin(), keyed.end());
  for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = keyed[i].second;
  return edges;
}

void split_long_edges(SheetGrid& grid, const FacePair& faces) {
  for (const auto& [a, b] : edges_by_length(grid, true)) {
    if (relative_length(grid, a, b) <= kSplit || !grid.has_edge(a, b)) continue;
    const Vec3 middle = 0.5 * (grid.x[at(a)] + grid.x[at(b)]);
    grid.split(a, b, grid.on_border(a, b) ? faces.on_rim(middle) : faces.centred(middle));
  }
}

// edges shorter than `share` of the wanted length; where the sheet is crumpled, the faces say how
// its cells should look
void collapse_short_edges(SheetGrid& grid, const FacePair& faces, double share) {
  constexpr double kCrumpled = 0.35;
  for (auto [a, b] : edges_by_length(grid, false)) {
    const double length = relative_length(grid, a, b);
    if (length >= share || !grid.has_edge(a, b)) continue;
    if (grid.pinned[at(a)] && grid.pinned[at(b)]) continue;
    if (grid.rim[at(b)] > grid.rim[at(a)] || grid.pinned[at(b)]) std::swap(a, b);
    const bool both = grid.rim[at(a)] == grid.rim[at(b)] && !grid.pinned[at(a)];
    Vec3 place = both ? Vec3(0.5 * (grid.x[at(a)] + grid.x[at(b)])) : grid.x[at(a)];
    if (both) place = grid.rim[at(a)] ? faces.on_rim(place) : faces.centred(place);
    if (!grid.collapse(a, b, place, kSplit) && length < kCrumpled)
      grid.collapse(a, b, place, kSplit, faces.up(place));
  }
}

double opposite_angle(const SheetGrid& grid, Index a, Index b, Index corner) {
  const Vec3 u = grid.x[at(a)] - grid.x[at(corner)], v = grid.x[at(b)] - grid.x[at(corner)];
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// flips towards six cells around a node (four on the border), or towards Delaunay
void flip_edges(SheetGrid& grid, bool by_valence) {
  const auto excess = [&](Index v, int change) {
    const int ideal = grid.rim[at(v)] ? 3 : 6;
    const int d = static_cast<int>(grid.around(v).size()) + change - ideal;
    return d * d;
  };
  for (const auto& [a, b] : grid.edges()) {
    if (!grid.has_edge(a, b)) continue;
    const auto corners = grid.across(a, b);
    if (!corners) continue;
    const auto [c, d] = *corners;
    const double angles = opposite_angle(grid, a, b, c) + opposite_angle(grid, a, b, d);
    if (by_valence) {
      const int before = excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0);
      const int after = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
      if (after < before && angles > 0.6 * kPi) grid.flip(a, b);
    } else if (angles > kPi + 1e-6) {
      grid.flip(a, b);
    }
  }
}

// smoothing forces: to the weighted centre of the cells around, along the sheet only
void smooth(SheetGrid& grid, const FacePair& faces) {
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    if (!grid.alive(v) || grid.pinned[at(v)]) continue;
    Vec3 sum = Vec3::Zero();
    double weights = 0.0;
    if (grid.rim[at(v)]) {
      for (const Index u : grid.neighbours(v)) {
        if (!grid.on_border(u, v)) continue;
        const double w = 1.0 / grid.size[at(u)];
        sum += w * grid.x[at(u)];
        weights += w;
      }
    } else {
      for (const Index c : grid.around(v)) {
        const auto& [i, j, k] = grid.cell(c);
        const Vec3 &a = grid.x[at(i)], &b = grid.x[at(j)], &d = grid.x[at(k)];
        const double edge = (grid.size[at(i)] + grid.size[at(j)] + grid.size[at(k)]) / 3.0;
        const double w = (b - a).cross(d - a).norm() / (edge * edge);
        sum += w * (a + b + d) / 3.0;
        weights += w;
      }
    }
    if (weights <= 0.0) continue;
    Vec3 step = kRelax * (sum / weights - grid.x[at(v)]);
    const Vec3 n = grid.normal(v);
    step -= n * n.dot(step);
    const Vec3 moved = grid.x[at(v)] + step;
    grid.x[at(v)] = grid.rim[at(v)] ? faces.on_rim(moved) : faces.centred(moved);
  }
}

// the node of a cell at edge a-b that belongs to this cell only, if it is less than `low` away
std::optional<Index> low_ear(const SheetGrid& grid, Index a, Index b, double low) {
  const auto corners = grid.across(a, b);
  for (const Index c : {corners->first, corners->second}) {
    if (grid.around(c).size() != 1) continue;
    const Vec3 edge = grid.x[at(b)] - grid.x[at(a)], offset = grid.x[at(c)] - grid.x[at(a)];
    if (edge.cross(offset).norm() < low * edge.norm()) return c;
  }
  return std::nullopt;
}

// an edge inside the sheet must not join two nodes of its rim: at a knife edge the body would have
// no height there. Turned if possible, else freed of a low ear, else split
void part_rim_nodes(SheetGrid& grid, const FacePair& faces) {
  constexpr double kLowEar = 0.3;  // mm
  for (bool turning : {true, false}) {
    for (const auto& [a, b] : grid.edges()) {
      if (!grid.rim[at(a)] || !grid.rim[at(b)] || !grid.has_edge(a, b) || grid.on_border(a, b))
        continue;
      if (turning) {
        grid.flip(a, b);
      } else if (const auto ear = low_ear(grid, a, b, kLowEar)) {
        grid.drop_ear(*ear);
      } else {
        grid.split(a, b, faces.centred(0.5 * (grid.x[at(a)] + grid.x[at(b)])));
      }
    }
  }
}

MedialSheet to_sheet(SheetGrid& grid, const FacePair& faces) {
  grid.compact();
  MedialSheet sheet;
  const Index n = grid.n_nodes();
  sheet.nodes.resize(n, 3);
  sheet.first_feet.resize(n, 3);
  sheet.second_feet.resize(n, 3);
  sheet.radii.resize(n);
  sheet.rim = grid.rim;
  sheet.corners = grid.pinned;
  for (Index v = 0; v < n; ++v) {
    const BallFeet f = grid.rim[at(v)] ? faces.rim_feet(grid.x[at(v)]) : faces.feet(grid.x[at(v)]);
    sheet.nodes.row(v) = grid.x[at(v)];
    sheet.first_feet.row(v) = f.first;
    sheet.second_feet.row(v) = f.second;
    sheet.radii[v] = 0.5 * (f.first - f.second).norm();
  }
  const auto cells = grid.cells();
  sheet.cells.resize(static_cast<Eigen::Index>(cells.size()), 3);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      sheet.cells(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(k)) = cells[c][k];
    }
  }
  return sheet;
}

}  // namespace

MedialSheet fit_medial_sheet(const TriMesh& surface, const SurfaceSides& sides,
                             const MedialOptions& options, const Monitor& monitor) {
  require(sides.labels.size() == at(surface.n_triangles()),
          "sides must label every triangle: ", sides.labels.size(), " labels for ",
          surface.n_triangles(), " triangles");
  return fit_medial_sheet(FacePair(surface, sides), options, monitor);
}

MedialSheet fit_medial_sheet(const FacePair& faces, const MedialOptions& options,
                             const Monitor& monitor) {
  check(options);
  SheetGrid grid = starting_grid(faces);
  const CellSizing sizing = sizing_for(grid, size_basis(grid, faces, options), options);
  pin_corners(grid, faces);
  for (int k = 0; k < options.iterations; ++k) {
    monitor.check_cancelled();
    monitor.progress("medial grid", static_cast<double>(k) / options.iterations);
    if (k > 0) update_sizes(grid, size_basis(grid, faces, options), sizing);
    const bool shaping = k < options.iterations - 3;
    if (k == options.iterations - 3) part_rim_nodes(grid, faces);
    if (shaping) {
      split_long_edges(grid, faces);
      collapse_short_edges(grid, faces, kCollapse);
    }
    if (!shaping) collapse_short_edges(grid, faces, kTiny);
    flip_edges(grid, shaping);
    for (int s = 0; s < 3; ++s) smooth(grid, faces);
    flip_edges(grid, false);
  }
  part_rim_nodes(grid, faces);
  return to_sheet(grid, faces);
}

}  // namespace coxa::medial
