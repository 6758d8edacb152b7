#include "curve_paths.h"

#include "tet_boundary.h"
#include "worst_elements.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

namespace coxa::meshing {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

class Paths {
 public:
  Paths(const TetGrid& grid, const FeatureCurves& features)
      : grid_(grid), features_(features), next_(grid.x.size()), owner_(grid.x.size(), kFree) {
    const Triangles facets = boundary_of(grid);
    for (Index f = 0; f < facets.rows(); ++f)
      for (int k = 0; k < 3; ++k) next_[at(facets(f, k))].push_back(facets(f, (k + 1) % 3));
  }

  const std::vector<FeatureNode>& chosen() const { return chosen_; }

  void take_corners() {
    for (std::size_t c = 0; c < features_.corners.size(); ++c) {
      corners_.push_back(nearest_free(features_.corners[c]));
      if (corners_.back() >= 0) take({corners_.back(), -1, static_cast<Index>(c)});
    }
    for (std::size_t c = 0; c < corners_.size(); ++c)
      if (corners_[c] >= 0) reserve_around(static_cast<Index>(c));
  }

  void take_path(Index number) {
    const FeatureCurve& curve = features_.curves[at(number)];
    if (!curve.closed()) {
      const Index a = corners_[at(curve.first)], b = corners_[at(curve.last)];
      if (a >= 0 && b >= 0 && a != b) connect(a, b, number);
      return;
    }
    // a loop by way of three of its places
    std::vector<Index> stops;
    for (std::size_t k = 0; k < 3; ++k) {
      stops.push_back(nearest_free(curve.points[k * curve.points.size() / 3]));
      if (stops.back() < 0) return;
      take({stops.back(), number, -1});
    }
    for (std::size_t k = 0; k < 3; ++k) connect(stops[k], stops[(k + 1) % 3], number);
  }

 private:
  static constexpr Index kFree = -1, kTaken = -2;

  void take(const FeatureNode& f) {
    owner_[at(f.node)] = kTaken;
    chosen_.push_back(f);
  }

  // every curve that ends at a corner gets the neighbour of its node that is nearest to the curve,
  // so that the others do not shut it in
  void reserve_around(Index corner) {
    const Index v = corners_[at(corner)];
    std::vector<std::tuple<double, Index, Index>> pairs;  // distance, curve, neighbour
    for (std::size_t c = 0; c < features_.curves.size(); ++c) {
      const FeatureCurve& curve = features_.curves[c];
      if (curve.first != corner && curve.last != corner) continue;
      for (const Index u : next_[at(v)]) {
        const CurvePlace place = nearest_on(curve, grid_.x[at(u)]);
        // a neighbour beyond the corner is nearest to the corner itself
        const double length = (grid_.x[at(u)] - grid_.x[at(v)]).norm();
        if (owner_[at(u)] == kFree &&
            (place.point - features_.corners[at(corner)]).norm() > 0.1 * length)
          pairs.emplace_back(place.distance / length, static_cast<Index>(c), u);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<char> served(features_.curves.size(), 0);
    for (const auto& [distance, c, u] : pairs) {
      if (served[at(c)] || owner_[at(u)] != kFree) continue;
      owner_[at(u)] = c;
      served[at(c)] = 1;
    }
  }

  Index nearest_free(const Vec3& p) const {
    Index best = -1;
    double least = kInfinity;
    for (std::size_t v = 0; v < next_.size(); ++v) {
      if (next_[v].empty() || owner_[v] != kFree) continue;
      const double distance = (grid_.x[v] - p).norm();
      if (distance >= least) continue;
      least = distance;
      best = static_cast<Index>(v);
    }
    return best;
  }

  // length of an edge, more where it is away from the curve
  double cost(Index a, Index b, const FeatureCurve& curve) const {
    constexpr double kAway = 10.0;
    const Vec3 &p = grid_.x[at(a)], &q = grid_.x[at(b)];
    const double length = (q - p).norm();
    if (!(length > 0.0)) return kInfinity;
    const double away =
        0.5 * (nearest_on(curve, p).distance + nearest_on(curve, q).distance) / length;
    return length * (1.0 + kAway * away * away);
  }

  // the cheapest way from a to b by free nodes (Dijkstra)
  void connect(Index a, Index b, Index number) {
    const FeatureCurve& curve = features_.curves[at(number)];
    std::vector<double> least(next_.size(), kInfinity);
    std::vector<Index> from(next_.size(), -1);
    using Item = std::pair<double, Index>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
    least[at(a)] = 0.0;
    open.emplace(0.0, a);
    while (!open.empty() && open.top().second != b) {
      const auto [sum, v] = open.top();
      open.pop();
      if (sum > least[at(v)]) continue;
      for (const Index u : next_[at(v)]) {
        if (owner_[at(u)] != kFree && owner_[at(u)] != number && u != b) continue;
        const double there = sum + cost(v, u, curve);
        if (there >= least[at(u)]) continue;
        least[at(u)] = there;
        from[at(u)] = v;
        open.emplace(there, u);
      }
    }
    if (from[at(b)] < 0) return;
    for (Index v = from[at(b)]; v != a; v = from[at(v)]) take({v, number, -1});
  }

  const TetGrid& grid_;
  const FeatureCurves& features_;
  std::vector<std::vector<Index>> next_;  // along edges of the boundary
  std::vector<Index> owner_;              // the curve a node is kept for, or one of the above
  std::vector<Index> corners_;            // nodes; -1 where none is left
  std::vector<FeatureNode> chosen_;
};

Vec3 target_of(const TetGrid& grid, const FeatureCurves& features, const FeatureNode& f) {
  return f.corner >= 0 ? features.corners[at(f.corner)]
                       : nearest_on(features.curves[at(f.curve)], grid.x[at(f.node)]).point;
}

}  // namespace

std::vector<FeatureNode> choose_paths(TetGrid& grid, const FeatureCurves& features) {
  Paths paths(grid, features);
  paths.take_corners();
  for (std::size_t c = 0; c < features.curves.size(); ++c) paths.take_path(static_cast<Index>(c));
  for (const FeatureNode& f : paths.chosen()) grid.kinds[at(f.node)] = NodeKind::first_corner;
  return paths.chosen();
}

void draw_to_features(TetGrid& grid, const FeatureCurves& features,
                      const std::vector<FeatureNode>& chosen) {
  constexpr double kWorst = 60.0;  // shape energy allowed just then
  for (const FeatureNode& f : chosen) {
    const Index v = f.node;
    if (grid.kinds[at(v)] != NodeKind::first_corner || grid.around[at(v)].empty()) continue;
    const double share = draw_node(grid, v, target_of(grid, features, f), kWorst);
    if (share == 1.0 && f.curve >= 0) grid.kinds[at(v)] = NodeKind::first_crease;
    grid.reach[at(v)] = 0.0;
  }
}

void release_missed(TetGrid& grid, const FeatureCurves& features,
                    const std::vector<FeatureNode>& chosen) {
  constexpr double kThere = 1e-6;  // mm
  for (const FeatureNode& f : chosen)
    if (grid.kinds[at(f.node)] == NodeKind::first_corner &&
        (target_of(grid, features, f) - grid.x[at(f.node)]).norm() > kThere)
      grid.kinds[at(f.node)] = NodeKind::first_face;
}

}  // namespace coxa::meshing
