#include "extrude.h"

#include <coxa/core/error.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coxa::meshing {
namespace {

using medial::MedialSheet;

// a rim lower than this share of the cells around it is a knife edge: its two feet become one node
constexpr double kKnifeEdge = 0.25;
constexpr double kFirstShift =
    0.25;                     // of the step along the diagonal: half a cell between two levels
constexpr int kRimRings = 3;  // rings from the rim within which layers may be fewer

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Column {
  Index base = 0;  // node on the first face
  int layers = 0;  // 0: the two feet are one node
};

struct Plan {
  std::vector<int> order_of;    // rank of each sheet node along the diagonals
  std::vector<Vec3> shift;      // quarter step along the diagonals, mm
  std::vector<double> spacing;  // mean edge length around each node, mm
  std::vector<int> ring;        // 0 on the rim, 1 beside it, … up to kRimRings
  std::vector<Column> columns;
};

// nodes sorted along the longest axis of the sheet
std::vector<int> order_nodes(const MedialSheet& sheet) {
  const Vec3 mean = sheet.nodes.colwise().mean();
  const Points centred = sheet.nodes.rowwise() - mean.transpose();
  const Mat3 covariance = centred.transpose() * centred;
  const Vec3 axis = Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().col(2);
  const VecX along = centred * axis;
  std::vector<Index> sorted(at(static_cast<Index>(along.size())));
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(),
            [&](Index a, Index b) { return along[a] != along[b] ? along[a] < along[b] : a < b; });
  std::vector<int> order(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) order[at(sorted[i])] = static_cast<int>(i);
  return order;
}

std::array<Index, 3> sorted_cell(const MedialSheet& sheet, const std::vector<int>& order, Index c) {
  std::array<Index, 3> v{sheet.cells(c, 0), sheet.cells(c, 1), sheet.cells(c, 2)};
  std::sort(v.begin(), v.end(), [&](Index a, Index b) { return order[at(a)] < order[at(b)]; });
  return v;
}

void plan_shifts(const MedialSheet& sheet, Plan& plan) {
  const std::size_t n = at(static_cast<Index>(sheet.nodes.rows()));
  plan.shift.assign(n, Vec3::Zero());
  plan.spacing.assign(n, 0.0);
  std::vector<int> count(n, 0);
  for (Index c = 0; c < sheet.cells.rows(); ++c) {
    const auto v = sorted_cell(sheet, plan.order_of, c);
    const Vec3 diagonal = (sheet.nodes.row(v[2]) - sheet.nodes.row(v[0])).transpose();
    double perimeter = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      perimeter += (sheet.nodes.row(v[k]) - sheet.nodes.row(v[(k + 1) % 3])).norm();
    }
    for (const Index i : v) {
      plan.shift[at(i)] += kFirstShift * diagonal;
      plan.spacing[at(i)] += perimeter / 3.0;
      ++count[at(i)];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    plan.shift[i] /= std::max(count[i], 1);
    plan.spacing[i] /= std::max(count[i], 1);
  }
}

void plan_rings(const MedialSheet& sheet, Plan& plan) {
  plan.ring.assign(at(static_cast<Index>(sheet.nodes.rows())), kRimRings);
  for (std::size_t i = 0; i < plan.ring.size(); ++i) {
    if (sheet.rim[i]) plan.ring[i] = 0;
  }
  for (int pass = 1; pass < kRimRings; ++pass) {
    for (Index c = 0; c < sheet.cells.rows(); ++c) {
      for (int k = 0; k < 3; ++k) {
        const Index a = sheet.cells(c, k), b = sheet.cells(c, (k + 1) % 3);
        plan.ring[at(a)] = std::min(plan.ring[at(a)], plan.ring[at(b)] + 1);
        plan.ring[at(b)] = std::min(plan.ring[at(b)], plan.ring[at(a)] + 1);
      }
    }
  }
}

// thickness beyond the rim zone, carried out to the rim
std::vector<double> full_thickness(const MedialSheet& sheet) {
  std::vector<double> full(at(static_cast<Index>(sheet.nodes.rows())));
  for (std::size_t i = 0; i < full.size(); ++i) full[i] = 2.0 * sheet.radii[static_cast<Index>(i)];
  for (int pass = 0; pass < kRimRings; ++pass) {
    const std::vector<double> before = full;
    for (Index c = 0; c < sheet.cells.rows(); ++c) {
      for (int k = 0; k < 3; ++k) {
        const Index a = sheet.cells(c, k), b = sheet.cells(c, (k + 1) % 3);
        full[at(a)] = std::max(full[at(a)], before[at(b)]);
        full[at(b)] = std::max(full[at(b)], before[at(a)]);
      }
    }
  }
  return full;
}

Index plan_columns(const MedialSheet& sheet, int layers, Plan& plan) {
  const std::vector<double> full = full_thickness(sheet);
  plan.columns.resize(plan.ring.size());
  Index next = 0, reduced = 0;
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    const double height = 2.0 * sheet.radii[static_cast<Index>(i)];
    Column& column = plan.columns[i];
    column.layers = layers;
    if (plan.ring[i] < kRimRings && height < full[i]) {
      column.layers =
          std::clamp(static_cast<int>(std::lround(layers * height / full[i])), 1, layers);
      if (plan.ring[i] == 0 && height < kKnifeEdge * plan.spacing[i]) column.layers = 0;
    }
    if (column.layers < layers) ++reduced;
    column.base = next;
    next += column.layers + 1;
  }
  return reduced;
}

NodeKind kind_of(bool rim, bool corner, int layers, int level) {
  if (layers == 0) return corner ? NodeKind::rim_corner : NodeKind::rim_edge;
  if (level == 0) {
    return corner ? NodeKind::first_corner : rim ? NodeKind::first_border : NodeKind::first_face;
  }
  if (level == layers) {
    return corner ? NodeKind::second_corner : rim ? NodeKind::second_border : NodeKind::second_face;
  }
  return rim ? NodeKind::rim_band : NodeKind::inside;
}

// corners start, and stay, where nodes that slide would start
Vec3 start_of(NodeKind kind, const Vec3& p, const SlideGuide& guide) {
  switch (kind) {
    case NodeKind::rim_corner:
      return guide.place(NodeKind::rim_edge, p);
    case NodeKind::first_corner:
      return guide.place(NodeKind::first_border, p);
    case NodeKind::second_corner:
      return guide.place(NodeKind::second_border, p);
    default:
      return guide.place(kind, p);
  }
}

void add_nodes(const MedialSheet& sheet, const SlideGuide& guide, int layers, const Plan& plan,
               TetGrid& grid) {
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    const Index node = static_cast<Index>(i);
    const int n = plan.columns[i].layers;
    for (int level = 0; level <= n; ++level) {
      const double share = n == 0 ? 0.5 : static_cast<double>(level) / n;
      const NodeKind kind = kind_of(sheet.rim[i] != 0, sheet.corners[i] != 0, n, level);
      Vec3 p = (1.0 - share) * sheet.first_feet.row(node).transpose() +
               share * sheet.second_feet.row(node).transpose();
      if (n == 0) p = sheet.nodes.row(node);
      // full columns away from the rim: every other level forward, the rest backward
      if (n == layers && plan.ring[i] > 0) p += (level % 2 == 0 ? 1.0 : -1.0) * plan.shift[i];
      grid.x.push_back(start_of(kind, p, guide));
      grid.kinds.push_back(kind);
      grid.levels.push_back(share * layers);
    }
  }
}

struct Advance {
  double share;  // of the column's height reached
  int order;     // between columns that reach the same share
  std::size_t corner;
};

// climbs the three columns of a cell to the top, one node and one tetrahedron at a time; the order
// depends on the columns alone, so that two cells agree on the wall between them
void stack_cell(const std::array<Index, 3>& cell, int layers, const Plan& plan, TetGrid& grid) {
  std::vector<Advance> steps;
  for (std::size_t k = 0; k < 3; ++k) {
    const int n = plan.columns[at(cell[k])].layers;
    for (int level = 1; level <= n; ++level) {
      const double share = static_cast<double>(level) / n;
      const int layer = static_cast<int>(std::ceil(share * layers - 1e-9));
      const int sign = layer % 2 == 1 ? -1 : 1;
      steps.push_back({share, sign * plan.order_of[at(cell[k])], k});
    }
  }
  std::sort(steps.begin(), steps.end(), [](const Advance& a, const Advance& b) {
    return a.share != b.share ? a.share < b.share : a.order < b.order;
  });
  std::array<Index, 3> front;
  for (std::size_t k = 0; k < 3; ++k) front[k] = plan.columns[at(cell[k])].base;
  for (const Advance& step : steps) {
    const Index reached = front[step.corner] + 1;
    grid.tets.push_back({front[0], front[1], front[2], reached});
    front[step.corner] = reached;
  }
}

}  // namespace

Index drop_inverted_cells(Extrusion& made) {
  TetGrid& grid = made.grid;
  std::vector<double> volumes(made.cells.size(), 0.0);
  std::vector<char> bad(made.cells.size(), 0);
  for (std::size_t t = 0; t < grid.tets.size(); ++t) {
    const Tet& n = grid.tets[t];
    const double volume =
        volume6(grid.x[at(n[0])], grid.x[at(n[1])], grid.x[at(n[2])], grid.x[at(n[3])]);
    volumes[at(made.cell_of[t])] += volume;
    if (!(volume > 0.0)) bad[at(made.cell_of[t])] = 1;
  }
  std::vector<medial::SheetCell> good;
  std::vector<double> weights;
  std::vector<std::size_t> number;
  for (std::size_t c = 0; c < bad.size(); ++c) {
    if (bad[c]) continue;
    good.push_back(made.cells[c]);
    weights.push_back(volumes[c]);
    number.push_back(c);
  }
  std::vector<char> kept(made.cells.size(), 0);
  const std::vector<char> stays = medial::manifold_part(good, weights);
  for (std::size_t i = 0; i < good.size(); ++i) kept[number[i]] = stays[i];
  std::vector<Tet> tets;
  std::vector<Index> cell_of;
  for (std::size_t t = 0; t < grid.tets.size(); ++t) {
    if (!kept[at(made.cell_of[t])]) continue;
    tets.push_back(grid.tets[t]);
    cell_of.push_back(made.cell_of[t]);
  }
  grid.tets = std::move(tets);
  made.cell_of = std::move(cell_of);
  grid.link();
  return static_cast<Index>(std::count(kept.begin(), kept.end(), 0));
}

Extrusion extrude(const MedialSheet& sheet, const SlideGuide& guide, int layers) {
  Plan plan;
  plan.order_of = order_nodes(sheet);
  plan_shifts(sheet, plan);
  plan_rings(sheet, plan);
  Extrusion made;
  made.n_reduced = plan_columns(sheet, layers, plan);
  add_nodes(sheet, guide, layers, plan, made.grid);
  for (Index c = 0; c < sheet.cells.rows(); ++c) {
    made.cells.push_back({sheet.cells(c, 0), sheet.cells(c, 1), sheet.cells(c, 2)});
    stack_cell(made.cells.back(), layers, plan, made.grid);
    made.cell_of.resize(made.grid.tets.size(), c);
  }
  made.grid.link();
  return made;
}

}  // namespace coxa::meshing
