#include "cell_sizing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace coxa::medial {
namespace {

constexpr double kSmallestRow = 0.6;    // mm: cells beside a knife edge are not made smaller
constexpr double kSmallestShare = 0.5;  // of the size by thickness: floor for cells at bends
constexpr double kLeastShare = 0.2;     // of the typical cell: floor where there is no thickness
constexpr double kEnlarge = 1.04;       // step in the search for the number of cells
constexpr int kMaxSteps = 200;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// a wedge of this angle, cut off at `rounding` and widening to its full height over the first row
// of cells, is blunt if that row is no wider than the result
double cell_beside_rim(double angle, const MedialOptions& o) {
  constexpr double kRowHeight = 0.87;  // of an equilateral cell
  if (o.knife_edge_rounding <= 0.0 || angle >= o.blunt_angle) return kInfinity;
  const double row = o.knife_edge_rounding / (1.0 - angle / o.blunt_angle);
  return std::max(row, kSmallestRow) / kRowHeight;
}

// where the straight edge between two feet leaves its face cells must be smaller: the error of a
// chord grows with the square of its length
void limit_at_bends(const SheetGrid& grid, const FacePair& faces, const std::vector<BallFeet>& feet,
                    double chord_error, std::vector<double>& limit) {
  for (const auto& [a, b] : grid.edges()) {
    if (grid.rim[at(a)] && grid.rim[at(b)]) continue;
    const BallFeet &fa = feet[at(a)], &fb = feet[at(b)];
    const Vec3 first = 0.5 * (fa.first + fb.first), second = 0.5 * (fa.second + fb.second);
    const double error = std::sqrt(std::max(faces.first_tree().nearest(first).squared_distance,
                                            faces.second_tree().nearest(second).squared_distance));
    if (error <= 0.0) continue;
    const double length = (grid.x[at(a)] - grid.x[at(b)]).norm();
    const double allowed = length * std::sqrt(chord_error / error);
    for (const Index v : {a, b}) limit[at(v)] = std::min(limit[at(v)], allowed);
  }
}

double expected_cells(const SheetGrid& grid) {
  double sum = 0.0;
  for (const auto& c : grid.cells()) {
    const Vec3 &a = grid.x[at(c[0])], &b = grid.x[at(c[1])], &d = grid.x[at(c[2])];
    const double area = 0.5 * (b - a).cross(d - a).norm();
    const double edge = (grid.size[at(c[0])] + grid.size[at(c[1])] + grid.size[at(c[2])]) / 3.0;
    sum += area / (std::sqrt(3.0) / 4.0 * edge * edge);
  }
  return sum;
}

double median_thickness(const SheetGrid& grid, const SizeBasis& basis) {
  std::vector<double> inner;
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    if (grid.alive(v) && !grid.rim[at(v)]) inner.push_back(basis.thickness[at(v)]);
  }
  if (inner.empty()) return 1.0;
  std::sort(inner.begin(), inner.end());
  return inner[inner.size() / 2];
}

}  // namespace

SizeBasis size_basis(const SheetGrid& grid, const FacePair& faces, const MedialOptions& options) {
  SizeBasis basis{std::vector<double>(grid.x.size(), 0.0),
                  std::vector<double>(grid.x.size(), kInfinity),
                  std::vector<double>(grid.x.size(), kInfinity)};
  std::vector<BallFeet> feet(grid.x.size());
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    if (!grid.alive(v)) continue;
    BallFeet& f = feet[at(v)];
    f = grid.rim[at(v)] ? faces.rim_feet(grid.x[at(v)]) : faces.feet(grid.x[at(v)]);
    basis.thickness[at(v)] = (f.first - f.second).norm();
    if (grid.rim[at(v)]) {
      basis.rim[at(v)] = cell_beside_rim(faces.rim_wedge(grid.x[at(v)]).angle, options);
    }
  }
  limit_at_bends(grid, faces, feet, options.chord_error, basis.bend);
  return basis;
}

void update_sizes(SheetGrid& grid, const SizeBasis& basis, const CellSizing& sizing) {
  for (Index v = 0; v < grid.n_nodes(); ++v) {
    const double wanted =
        std::clamp(sizing.per_thickness * basis.thickness[at(v)], sizing.smallest, sizing.largest);
    const double at_bend = std::max(sizing.slack * basis.bend[at(v)], kSmallestShare * wanted);
    grid.size[at(v)] = std::min({wanted, at_bend, sizing.slack * basis.rim[at(v)]});
  }
  const auto edges = grid.edges();
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : edges) {
      const double reach = sizing.gradation * (grid.x[at(a)] - grid.x[at(b)]).norm();
      for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
        if (grid.size[at(to)] > grid.size[at(from)] + reach + 1e-9) {
          grid.size[at(to)] = grid.size[at(from)] + reach;
          changed = true;
        }
      }
    }
  }
}

CellSizing sizing_for(SheetGrid& grid, const SizeBasis& basis, const MedialOptions& options) {
  CellSizing sizing{options.cell_per_thickness,
                    std::max(options.smallest_cell, 1e-3 * options.largest_cell),
                    options.largest_cell, 1.0, options.gradation};
  const double typical = options.cell_per_thickness * median_thickness(grid, basis);
  // places without thickness would ask for cells without number
  sizing.smallest = std::max(sizing.smallest, kLeastShare * typical);
  update_sizes(grid, basis, sizing);
  for (int step = 0; step < kMaxSteps && expected_cells(grid) > options.max_cells; ++step) {
    if (sizing.smallest < typical) {
      sizing.smallest = std::min(typical, std::max(kEnlarge * sizing.smallest, 0.25 * typical));
    } else {
      sizing.smallest *= kEnlarge;
      sizing.per_thickness *= kEnlarge;
      sizing.largest *= kEnlarge;
      sizing.slack *= kEnlarge;
    }
    update_sizes(grid, basis, sizing);
  }
  return sizing;
}

}  // namespace coxa::medial
