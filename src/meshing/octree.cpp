#include "octree.h"

#include <coxa/mesh/measures.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Polygon = std::vector<Vec3>;

// the part of the polygon where sign * (x[axis] - limit) <= 0
Polygon clipped(const Polygon& polygon, int axis, double limit, double sign) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = sign * (p[axis] - limit), b = sign * (q[axis] - limit);
    if (a <= 0.0) kept.push_back(p);
    if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) kept.push_back(p + a / (a - b) * (q - p));
  }
  return kept;
}

struct Box {
  Vec3 low, high;
};

Polygon part_inside(const TriMesh& surface, Index t, const Box& box) {
  Polygon polygon;
  for (int k = 0; k < 3; ++k) polygon.push_back(surface.points.row(surface.triangles(t, k)));
  for (int axis = 0; axis < 3; ++axis) {
    double low = kInfinity, high = -kInfinity;
    for (const Vec3& p : polygon) {
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
    if (low > box.high[axis] || high < box.low[axis]) return {};
    if (low < box.low[axis]) polygon = clipped(polygon, axis, box.low[axis], -1.0);
    if (high > box.high[axis]) polygon = clipped(polygon, axis, box.high[axis], 1.0);
  }
  return polygon;
}

// Whether the pieces lie within `flatness` of one plane and all look to the same side of it.
bool is_flat(const std::vector<Polygon>& pieces, double flatness) {
  constexpr double kFolded = 0.5;  // mean of the unit normals: cosine of a bend of 120 degrees
  double total = 0.0;
  Vec3 centre = Vec3::Zero(), oriented = Vec3::Zero();
  std::vector<double> areas;
  for (const Polygon& piece : pieces) {
    Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
    for (std::size_t i = 0; i < piece.size(); ++i) {
      normal += 0.5 * (piece[i] - piece[0]).cross(piece[(i + 1) % piece.size()] - piece[0]);
      middle += piece[i] / static_cast<double>(piece.size());
    }
    areas.push_back(normal.norm());
    total += areas.back();
    oriented += normal;
    centre += areas.back() * middle;
  }
  if (!(total > 0.0)) return true;
  if (oriented.norm() < kFolded * total) return false;
  centre /= total;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const Vec3& p : pieces[i])
      covariance += areas[i] / static_cast<double>(pieces[i].size()) * (p - centre) *
                    (p - centre).transpose();
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().col(0);
  double low = kInfinity, high = -kInfinity;
  for (const Polygon& piece : pieces)
    for (const Vec3& p : piece) {
      low = std::min(low, normal.dot(p));
      high = std::max(high, normal.dot(p));
    }
  return high - low <= 2.0 * flatness;
}

bool is_inside(const Vec3& p, const Box& box) {
  return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

constexpr int kMostLevels = 16;
// a cube this much larger than asked for is small enough: halving is not exact
constexpr double kAsSmall = 1.0 + 1e-9;

// what a cube must look at
struct Share {
  Index cell = 0;
  std::vector<Index> triangles;
  std::vector<FinePlace> fine_places;
};

}  // namespace

Octree::Octree(const TriMesh& surface, const OctreeOptions& options) {
  const Bounds box = bounds(surface.points);
  const double wanted = 1.1 * (box.high - box.low).maxCoeff();
  int levels = 2;
  while (levels < kMostLevels && std::ldexp(options.smallest, levels) < wanted) ++levels;
  // the root is larger than needed, so that the finest cubes are as small as asked for
  const double edge = std::max(wanted, std::ldexp(options.smallest, levels));
  double finest = options.smallest;
  for (const FinePlace& place : options.fine_places) finest = std::min(finest, place.size);
  while (levels < kMostLevels && std::ldexp(edge, -levels) > kAsSmall * finest) ++levels;
  OctreeCell root;
  root.size = 2 << levels;
  unit_ = edge / root.size;
  origin_ = 0.5 * (box.low + box.high) - Vec3::Constant(0.5 * edge);
  cells_.push_back(root);
  refine(surface, options);
  balance();
}

const OctreeCell* Octree::leaf_at(const GridPoint& p) const {
  for (const int x : p)
    if (x < 0 || x >= cells_[0].size) return nullptr;
  const OctreeCell* cell = cells_.data();
  while (cell->children > 0) {
    const GridPoint middle = cell->centre();
    const int corner = (p[0] >= middle[0]) + 2 * (p[1] >= middle[1]) + 4 * (p[2] >= middle[2]);
    cell = &cells_[at(cell->children + corner)];
  }
  return cell;
}

void Octree::split(Index cell) {
  const OctreeCell parent = cells_[at(cell)];
  cells_[at(cell)].children = static_cast<Index>(cells_.size());
  const int half = parent.size / 2;
  for (int corner = 0; corner < 8; ++corner) {
    OctreeCell child;
    child.low = {parent.low[0] + half * (corner & 1), parent.low[1] + half * (corner >> 1 & 1),
                 parent.low[2] + half * (corner >> 2)};
    child.size = half;
    cells_.push_back(child);
  }
}

double Octree::size_at(const Vec3& p) const {
  GridPoint q{};
  for (int k = 0; k < 3; ++k)
    q[static_cast<std::size_t>(k)] = static_cast<int>(std::floor((p[k] - origin_[k]) / unit_));
  const OctreeCell* leaf = leaf_at(q);
  return unit_ * (leaf != nullptr ? leaf->size : cells_[0].size);
}

void Octree::refine(const TriMesh& surface, const OctreeOptions& options) {
  constexpr double kMargin = 0.1;  // of the edge: a cube looks a little over its border
  std::vector<Index> all(at(surface.n_triangles()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Share> open{{0, std::move(all), options.fine_places}};
  while (!open.empty()) {
    const Share share = std::move(open.back());
    open.pop_back();
    const OctreeCell cell = cells_[at(share.cell)];
    const double edge = unit_ * cell.size;
    const Vec3 low = position(cell.low), margin = Vec3::Constant(kMargin * edge);
    const Box box{low - margin, low + Vec3::Constant(edge) + margin};
    Share inside;
    std::vector<Polygon> pieces;
    for (const Index t : share.triangles) {
      Polygon piece = part_inside(surface, t, box);
      if (piece.empty()) continue;
      inside.triangles.push_back(t);
      pieces.push_back(std::move(piece));
    }
    for (const FinePlace& place : share.fine_places)
      if (edge > kAsSmall * place.size && is_inside(place.p, box))
        inside.fine_places.push_back(place);
    if (cell.size <= 2 || (pieces.empty() && inside.fine_places.empty())) continue;
    const bool fine_enough = edge <= kAsSmall * options.smallest ||
                             (edge <= options.largest && is_flat(pieces, options.flatness));
    if (inside.fine_places.empty() && fine_enough) continue;
    split(share.cell);
    inside.cell = cells_[at(share.cell)].children;
    for (int k = 0; k < 8; ++k, ++inside.cell) open.push_back(inside);
  }
}

void Octree::balance() {
  std::vector<Index> open(cells_.size());
  std::iota(open.begin(), open.end(), 0);
  while (!open.empty()) {
    const Index number = open.back();
    open.pop_back();
    if (cells_[at(number)].children > 0) continue;
    const OctreeCell cell = cells_[at(number)];
    const GridPoint middle = cell.centre();
    for (int code = 0; code < 27; ++code) {
      const GridPoint step{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
      if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) > 2) continue;
      GridPoint p{};
      for (std::size_t k = 0; k < 3; ++k) p[k] = middle[k] + step[k] * cell.size;
      for (const OctreeCell* next = leaf_at(p); next != nullptr && next->size > 2 * cell.size;
           next = leaf_at(p)) {
        const auto large = static_cast<Index>(next - cells_.data());
        split(large);
        for (Index k = 0; k < 8; ++k) open.push_back(cells_[at(large)].children + k);
      }
    }
  }
}

}  // namespace coxa::meshing
